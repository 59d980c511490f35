"""What is private in viser and used here all the same: there is no public way to each of these.

    server._websock_server                  the websocket server of a `ViserServer`: who connects
      ._server_thread                       its thread, the only one that may set its events
      ._background_event_loop               its loop, to open the door once all is ready
      ._live_connections                    a client's connection: its number, its socket's buffer
      get_message_buffer().message_event    wakes the loop; replaced, since any thread sets it
      ...._sanctioned_dead_writes           messages to a tab that has gone, which are no mistake
    gui._gui_input_handle_from_uuid         the widget of a name that a browser sends
    panel._placement_uuid                   the panel of which one tab alone is told the width
    viser._messages                         the kinds of messages that a browser sends

`missing` is asked when a server starts, and by a test: should viser rename one of them, no page is
served rather than an open or a broken one.
"""

from __future__ import annotations

from typing import Any

import viser

# What a browser sends; viser has no public name for it.
from viser import _messages as messages  # pyright: ignore[reportPrivateUsage]

__all__ = [
    "allow_late_message",
    "connection_of",
    "loop_of",
    "messages",
    "missing",
    "panel_in",
    "sockets_of",
    "widget_of",
]

_SOCKETS = ("_server_thread", "_background_event_loop", "_live_connections", "get_message_buffer")
_BUFFER = ("message_event", "_sanctioned_dead_writes")
_MESSAGES = (
    "ViewerCameraMessage",
    "GuiUpdateMessage",
    "TransformControlsUpdateMessage",
    "CommandTriggerMessage",
    "TransformControlsDragStartMessage",
    "TransformControlsDragEndMessage",
    "SceneNodeClickMessage",
    "SceneNodeDragMessage",
    "LocalStorageGetItemResponseMessage",
)


def missing(server: viser.ViserServer) -> tuple[str, ...]:
    """The names above that this viser does not have."""
    sockets = getattr(server, "_websock_server", None)
    if sockets is None:
        return ("_websock_server",)
    absent = [name for name in _SOCKETS if not hasattr(sockets, name)]
    if "get_message_buffer" not in absent:
        buffer = sockets.get_message_buffer()
        absent += [name for name in _BUFFER if not hasattr(buffer, name)]
    if not hasattr(server.gui, "_gui_input_handle_from_uuid"):
        absent.append("_gui_input_handle_from_uuid")
    if not hasattr(server.gui.main_panel, "_placement_uuid"):
        absent.append("_placement_uuid")
    return (*absent, *(name for name in _MESSAGES if not hasattr(messages, name)))


def sockets_of(server: viser.ViserServer) -> Any:
    """The websocket server of a page's server."""
    return vars(server)["_websock_server"]


def loop_of(sockets: Any) -> tuple[Any, int]:
    """Its event loop, and the number of the thread that runs it."""
    return sockets._background_event_loop, int(sockets._server_thread.ident)


def connection_of(sockets: Any, client_id: int) -> Any:
    """The connection of a client that is there."""
    return sockets._live_connections[client_id]


def allow_late_message(buffer: Any) -> None:
    """Let one message be pushed to a tab that has gone without viser's warning of it."""
    buffer._sanctioned_dead_writes += 1


def widget_of(gui: viser.GuiApi, uuid: str) -> Any:
    """The widget of a server or a tab that viser knows by this name; None if it has none."""
    return vars(gui)["_gui_input_handle_from_uuid"].get(uuid)


def panel_in(client: viser.ClientHandle, panel: Any) -> Any:
    """A server's panel as one tab sees it alone."""
    # viser tells one tab alone of its main panel only; the handle takes any panel's name.
    handle: Any = client.gui.main_panel
    handle._placement_uuid = panel._placement_uuid
    return handle
