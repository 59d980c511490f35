"""`venus3d replay`: a recorded session on the guide's page, as a film, or as a document."""

from __future__ import annotations

from venus3d.cli.kept_session import options_of
from venus3d.cli.options import ReplayOptions
from venus3d.engine.errors import VenusError
from venus3d.languages import PageLanguage
from venus3d.scene.pages.guide.replay import run_replay
from venus3d.scene.pages.guide.replay_document import replay_document
from venus3d.scene.pages.guide.replay_film import replay_film
from venus3d.scene.pages.guide.run import settings_of
from venus3d.storage.folder import prepare
from venus3d.storage.products import product_place, write_product
from venus3d.storage.session_moments import moments_of
from venus3d.storage.session_reader import read_header


def replay(options: ReplayOptions) -> None:
    """Serve the page until Ctrl-C, or write a file. Raises `VenusError` for a user's mistake."""
    directory = options.session
    header = read_header(directory)
    settings = settings_of(options_of(header, directory))
    moments = moments_of(directory)
    if options.export is None:
        run_replay(
            moments, settings, host=options.host, port=options.port, language=options.language
        )
        return
    suffix = options.export.suffix.lower()
    if suffix not in (".mp4", ".html"):
        raise VenusError(f"A session is exported as .mp4 or .html, not as {options.export.name!r}.")
    # Before the work, which takes minutes.
    made = f"replay of the session begun {header.get('begun', '')}"
    product_place(options.export, made, option="--export")
    prepare(options.export.parent, "--export")
    with PageLanguage(options.language).spoken():
        content = (
            replay_film(moments, settings)
            if suffix == ".mp4"
            else replay_document(moments, settings, directory.resolve().name)
        )
    print(f"Written: {write_product(options.export, content, made, '--export')}")
