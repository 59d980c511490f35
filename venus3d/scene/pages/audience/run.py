"""From a person's options to the second monitor, and how its address is told."""

from __future__ import annotations

import socket

from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.audience.choices import AudienceChoices
from venus3d.scene.pages.guide.options import GuideOptions
from venus3d.scene.web.address import audience_address

_EVERYWHERE = ("0.0.0.0", "::")
_HERE = ("127.0.0.1", "::1", "localhost")


def open_audience(options: GuideOptions) -> Audience | None:
    """The second monitor that the options ask for, if any; the caller closes it.

    Raises `VenusError` for an address that cannot be had.
    """
    if options.audience is None:
        return None
    look = AudienceChoices(
        mirror=options.audience_mirror,
        lens=options.audience_view == "lens",
        light=options.audience_light,
        sound=options.audience_sound,
    )
    return Audience(*audience_address(options.audience, options.port), look)


def said_of(audience: Audience) -> str:
    """One line on where it is and who can look."""
    host = _address_for_others() if audience.host in _EVERYWHERE else audience.host
    reach = texts.THIS_MACHINE if audience.host in _HERE else texts.NETWORK
    shown = "localhost" if audience.host in _HERE else host
    return texts.ANNOUNCED.format(url=f"http://{shown}:{audience.port}", open_to=reach)


def _address_for_others() -> str:
    """The address by which others in the network reach this machine, as far as it knows."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing: only asks which way it would go
        except OSError:
            return socket.gethostname()
        return str(probe.getsockname()[0])
