"""Private names of viser that are used here, for lack of public ones.

    server._websock_server                  the websocket server of a `ViserServer`: who connects
      ._server_thread                       its thread, the only one that may set its events
      ._background_event_loop               its loop, to accept clients once all is ready
      ._live_connections                    a client's connection: its number, its socket's buffer
      get_message_buffer().message_event    wakes the loop; replaced, since any thread sets it
      ...._sanctioned_dead_writes           messages to a closed tab, which are no mistake
      ....message_counter, .generator_cursors   what is drawn, and what of it has been sent
    gui._gui_input_handle_from_uuid         the widget of a name that a browser sends
    panel._placement_uuid                   the panel, to set its width in a single tab
    server._thread_executor                 runs all callbacks; they speak their page's language
    viser._messages                         the kinds of messages that a browser sends

`missing` is checked at the start of a server and by a test: if viser renames one of them, no page
is served rather than an unprotected or broken one.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

import viser

# What a browser sends; viser has no public name for it.
from viser import _messages as messages  # pyright: ignore[reportPrivateUsage]
from websockets import Headers

__all__ = [
    "allow_late_message",
    "call_within",
    "connection_of",
    "headers_of",
    "loop_of",
    "messages",
    "missing",
    "newest_message",
    "newest_sent",
    "panel_in",
    "sockets_of",
    "widget_of",
]

_SOCKETS = ("_server_thread", "_background_event_loop", "_live_connections", "get_message_buffer")
_BUFFER = ("message_event", "_sanctioned_dead_writes", "message_counter", "generator_cursors")
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
    if not hasattr(server, "_thread_executor"):
        absent.append("_thread_executor")
    if not hasattr(server.gui.main_panel, "_placement_uuid"):
        absent.append("_placement_uuid")
    return (*absent, *(name for name in _MESSAGES if not hasattr(messages, name)))


def sockets_of(server: viser.ViserServer) -> Any:
    """The websocket server behind a page's server."""
    return vars(server)["_websock_server"]


def loop_of(sockets: Any) -> tuple[Any, int]:
    """Its event loop, and the id of the loop's thread."""
    return sockets._background_event_loop, int(sockets._server_thread.ident)


def connection_of(sockets: Any, client_id: int) -> Any:
    """The connection of a connected client."""
    return sockets._live_connections[client_id]


def headers_of(sockets: Any, client_id: int) -> Headers:
    """The headers with which a client came; none if it has gone."""
    connection = sockets._live_connections.get(client_id)
    return Headers() if connection is None else connection.request.headers


def server_of(client: viser.ClientHandle) -> viser.ViserServer:
    """The server of a connected tab."""
    return vars(client)["_viser_server"]


def allow_late_message(buffer: Any) -> None:
    """Let one message be pushed to a closed tab without viser's warning."""
    buffer._sanctioned_dead_writes += 1


def newest_message(sockets: Any) -> int:
    """The number of the newest message to all tabs."""
    return int(sockets.get_message_buffer().message_counter) - 1


def newest_sent(sockets: Any, unwatched: int) -> int:
    """The newest of these messages that has been sent to a tab; `unwatched` if there is no tab."""
    # A copy: tabs come and go meanwhile.
    return max(tuple(sockets.get_message_buffer().generator_cursors.values()), default=unwatched)


def call_within(
    server: viser.ViserServer,
    context: Callable[[int | None], AbstractContextManager[None]],
    failed: Callable[[Exception, int | None], None],
) -> None:
    """Run each callback within the context of the client that it is about, by its number; what it
    raises goes to `failed`, and no further."""
    executor = vars(server)["_thread_executor"]
    submit = executor.submit

    def submit_within(call: Callable[..., Any], *given: Any, **more: Any) -> Any:
        clients = [getattr(one, "client", one) for one in given]
        numbers = [one.client_id for one in clients if isinstance(one, viser.ClientHandle)]
        number = numbers[0] if numbers else None

        def run() -> Any:
            with context(number):
                try:
                    return call(*given, **more)
                except Exception as error:
                    failed(error, number)

        return submit(run)

    executor.submit = submit_within


def widget_of(gui: viser.GuiApi, uuid: str) -> Any:
    """The widget of a server or a tab with this name; None if there is none."""
    return vars(gui)["_gui_input_handle_from_uuid"].get(uuid)


def panel_in(client: viser.ClientHandle, panel: Any) -> Any:
    """A server's panel as seen by one tab alone."""
    # viser addresses only its main panel per tab; the handle takes any panel's name.
    handle: Any = client.gui.main_panel
    handle._placement_uuid = panel._placement_uuid
    return handle
