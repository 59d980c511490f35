"""The pages' web servers: viser's, restricted, and never tunnelled to the outside. `LocalServer` is
for operators, `ReadOnlyServer` for spectators. `handshake` decides who may connect, `incoming`
which messages are accepted."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import threading
import time
from collections.abc import Callable, Generator
from typing import Any, TypeVar

import rich
import viser
import websockets.asyncio.server as websockets_server
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from venus3d.languages import Language, PageLanguage, language_from
from venus3d.scene.web import terminal_texts, texts
from venus3d.scene.web.addresses import (
    AddressError,
    check_port,
    from_elsewhere,
    here,
    is_free,
    is_loopback,
)
from venus3d.scene.web.connection import LARGEST_MESSAGE_BYTES, Connection, Connections
from venus3d.scene.web.drawing import Failures
from venus3d.scene.web.handshake import RefusedError, came_from_here, check
from venus3d.scene.web.incoming import is_heard, is_point_of_view
from venus3d.scene.web.page_script import as_page
from venus3d.scene.web.token import Token
from venus3d.scene.web.viser_private import (
    allow_late_message,
    call_within,
    connection_of,
    headers_of,
    loop_of,
    missing,
    sockets_of,
    widget_of,
)

_PORTS_TRIED = 100
_ON_ITS_WAY_BYTES = 131072
"""Send-buffer size above which a slow browser skips pictures, which would come seconds late."""
_FREE_AGAIN_S = 10.0
_FAREWELL_S = 1.0
"""Seconds a browser may take to close its connection when the server stops."""

_Kind = TypeVar("_Kind", bound="LocalServer")


class LocalServer(viser.ViserServer):
    """viser's server, secured against strangers and against browsers that end the program.

    - The public tunnel is disabled.
    - Only our own page may connect (`handshake`), and only what a person could do on it is accepted
    (`incoming`).
    - Any thread may change the page while any number of browsers come and go.
    """

    shares_language = True
    """Whether all tabs show one page, in the language of the first browser."""
    scripts: tuple[str, ...] = ("fields", "window")
    """Names of the scripts that are added to the page (`page_script`)."""

    def __init__(
        self,
        host: str,
        port: int,
        *,
        language: PageLanguage | None = None,
        token: Token | None = None,
        **options: Any,
    ) -> None:
        """Serve on this address.

        Args:
            token: lets in only browsers that show it.
            language: of what all tabs share; the first browser's by default.
            options: viser's.
        """
        self.token = token
        self.language = language or PageLanguage()
        self.languages: dict[int, PageLanguage] = {}
        """Of tabs with a page of their own, by client."""
        self.on_first_browser: Callable[[], None] = lambda: None
        """Called on the server's thread once a browser has chosen another language."""
        self._complete = asyncio.Event()  # nobody may connect before
        self._serves = False
        with _serve_as(lambda *given, **more: self._serve(host, *given, **more)):
            super().__init__(host, port, **options)
        absent = missing(self)
        if absent or not self._serves:
            super().stop()
            raise RuntimeError(
                f"viser has changed ({', '.join(absent) or 'its websocket'}); install viser 1.1"
            )
        self._sockets = sockets_of(self)
        loop, self._sockets_thread = loop_of(self._sockets)
        self._make_safe(self._sockets.get_message_buffer())
        self._sockets.on_client_connect(self._welcome)
        self._failures = Failures()
        call_within(self, lambda n: self._spoken_with(n).spoken(), self._callback_failed)
        # What viser awaits on its loop, not on its threads.
        loop.call_soon_threadsafe(loop.set_exception_handler, self._loop_failed)
        loop.call_soon_threadsafe(self._complete.set)

    @property
    def url(self) -> str:
        """The page's address on this machine, with its token."""
        return self._address(here(self.get_host()))

    @property
    def outside_url(self) -> str:
        """The page's address on other machines; empty if they cannot reach it."""
        host = self.get_host()
        return "" if is_loopback(host) else self._address(from_elsewhere(host))

    def _address(self, name: str) -> str:
        token = "" if self.token is None else f"/?token={self.token.secret}"
        return f"http://{name}:{self.get_port()}{token}"

    def is_on_this_machine(self, client_id: int) -> bool:
        """Whether this tab's browser runs on this machine and has not come through a proxy."""
        if client_id not in self.get_clients():
            return False
        connection = connection_of(self._sockets, client_id)
        return came_from_here(connection.request.headers, connection.remote_address[0])

    def language_of(self, client_id: int) -> Language:
        """The language of a page for this tab alone: the chosen one, or its browser's."""
        if not self.language.is_open:
            return self.language.code
        headers = headers_of(self._sockets, client_id)
        return language_from(headers.get("accept-language", ""))

    def _spoken_with(self, client_id: int | None) -> PageLanguage:
        own = None if client_id is None else self.languages.get(client_id)
        return own or self.language

    def _hear_language(self, request: Request) -> Language:
        """The language in which this request is answered. The first browser that connects chooses
        the shared page's; a program that states no language does not."""
        accepted = request.headers.get("accept-language")
        if not self.language.is_open:
            return self.language.code
        asked = language_from(accepted or "")
        if accepted and request.headers.get("upgrade") and self.shares_language:
            self.language.is_open = False
            if asked != self.language.code:
                self.language.code = asked
                self.on_first_browser()
        return asked

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse: the camera's picture stays on this machine."""
        return None

    def stop(self) -> None:
        """Stop serving."""
        with _viser_is_quiet():
            super().stop()

    def _hears(self, raw: bytes, client_id: int) -> bool:
        """Whether viser should get this message."""
        client = self.get_clients().get(client_id)

        def find(uuid: str) -> Any:
            shared = widget_of(self.gui, uuid)
            return shared if shared or client is None else widget_of(client.gui, uuid)

        return is_heard(raw, find)

    def _welcome(self, client: Any) -> None:
        self._make_safe(client.get_message_buffer())
        connection_of(self._sockets, client.client_id).client_id = client.client_id

    def _callback_failed(self, error: Exception, client_id: int | None) -> None:
        """Log once what a click or another message led to, and tell its tab."""
        tab = None if client_id is None else self.get_clients().get(client_id)
        if tab is None and client_id is not None:
            return  # the tab has gone meanwhile
        self._failures.tell(error, terminal_texts.CALLBACK_FAILED)
        if tab is not None:
            cause = texts.ACTION_FAILED_WHY.format(cause=type(error).__name__)
            tab.add_notification(texts.ACTION_FAILED, cause, color="yellow")

    def _loop_failed(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        error = context.get("exception")
        if isinstance(error, Exception) and not isinstance(error, OSError):
            self._callback_failed(error, None)
        else:
            loop.default_exception_handler(context)

    def _make_safe(self, buffer: Any) -> None:
        """Let any thread push messages: viser sets its event outside the event's own thread, which
        with many browsers raises in the drawing thread."""
        assert isinstance(buffer.message_event, asyncio.Event)
        buffer.message_event = _LoopEvent(self._sockets_thread)
        # Drawing for a tab that has just closed is no mistake, though viser would warn of it.
        allow_late_message(buffer)

    def _serve(self, host: str, handler: Any, *address: Any, **options: Any) -> Any:
        self._serves = True
        answer: Any = options.get("process_request")

        async def let_in(connection: ServerConnection, request: Request) -> Response | None:
            await self._complete.wait()
            try:
                check(request.headers, host)
                cookie = None if self.token is None else self.token.check(request)
            except RefusedError as refused:
                return connection.respond(403, f"{refused}\n")
            if cookie is not None:
                return cookie
            language = self._hear_language(request)
            response = None if answer is None else answer(connection, request)
            if response is None:
                return None
            # Framed by another page, a click meant for that one could be a click on ours.
            response.headers["X-Frame-Options"] = "DENY"
            return as_page(response, self.scripts, language)

        connections = Connections(self._hears)

        def connection(*given: Any, **more: Any) -> Connection:
            return Connection(connections, *given, **more)

        ours = {
            "process_request": let_in,
            "create_connection": connection,
            "max_size": LARGEST_MESSAGE_BYTES,
            "close_timeout": _FAREWELL_S,
        }
        return _plain_serve(handler, *address, **{**options, **ours})


class ReadOnlyServer(LocalServer):
    """A server that shows but accepts nothing: no message from a browser reaches a callback,
    whatever is on the page. It only tracks each browser's own viewpoint."""

    scripts = ("audience",)

    def _hears(self, raw: bytes, client_id: int) -> bool:
        return is_point_of_view(raw)

    def _welcome(self, client: Any) -> None:
        super()._welcome(client)
        line = connection_of(self._sockets, client.client_id).transport
        line.get_extra_info("socket").setsockopt(
            socket.SOL_SOCKET, socket.SO_SNDBUF, _ON_ITS_WAY_BYTES
        )


class _LoopEvent(asyncio.Event):
    """An event that only its loop's thread sets. viser also sets it directly in the pushing thread,
    just before its loop does; that call is ignored."""

    def __init__(self, thread: int) -> None:
        super().__init__()
        self._thread = thread

    def set(self) -> None:
        if threading.get_ident() == self._thread:
            super().set()


_plain_serve = websockets_server.serve
_serving, _silencing = threading.Lock(), threading.RLock()


@contextlib.contextmanager
def _viser_is_quiet() -> Generator[None, None, None]:
    """Silences viser's printing: the command line prints instead."""
    console = rich.get_console()
    with _silencing:
        before, console.quiet = console.quiet, True
        try:
            yield
        finally:
            console.quiet = before


@contextlib.contextmanager
def _serve_as(serve: Callable[..., Any]) -> Generator[None, None, None]:
    """Makes viser open its websocket with `serve`, for which it has no option."""
    with _serving:
        websockets_server.serve = serve  # pyright: ignore[reportAttributeAccessIssue]
        try:
            yield
        finally:
            websockets_server.serve = _plain_serve


def start_server(
    host: str, port: int, language: Language | None = None, *, asks_token: bool = True
) -> tuple[LocalServer, str]:
    """A running server whose pages speak `language`, by default the browser's, and a note if it had
    to take another port than `port`. Raises `AddressError` if the address cannot be bound; this is
    tried first, since viser would wait for ever.

    Args:
        asks_token: beyond this machine, let in only browsers that show the token in its address.
    """
    check_port(port)
    for candidate in range(port, min(port + _PORTS_TRIED, 65536)):
        if is_free(host, candidate):
            break
    else:
        raise AddressError(f"No port from {port} on is free on {host}; choose another with --port.")
    token = _token(host, candidate, asks_token)
    server = _quietly(LocalServer, host, candidate, PageLanguage(language), token)
    taken = server.get_port()
    note = "" if taken == port else terminal_texts.PORT_TAKEN.format(port=port, taken=taken)
    return server, note


def start_read_only_server(
    host: str, port: int, language: Language | None = None, *, asks_token: bool = False
) -> ReadOnlyServer:
    """A running read-only server on exactly this port, which the second screen already knows, with
    a page in `language`, by default the first browser's. Raises `AddressError` if the address
    cannot be bound or the port is taken. `asks_token` as of `start_server`."""
    check_port(port)
    taken = AddressError(f"Port {port} is taken on {host}; choose another with --audience.")
    if not is_free(host, port):
        raise taken
    token = _token(host, port, asks_token)
    server = _quietly(ReadOnlyServer, host, port, PageLanguage(language), token)
    if server.get_port() != port:  # another program was quicker
        server.stop()
        raise taken
    return server


def serve_anew(server: _Kind, stop: threading.Event) -> _Kind:
    """A new, empty server of the same kind and address in place of this one, which is stopped.
    Browsers reconnect by themselves. If `stop` is set meanwhile, the new one is stopped too. Raises
    `AddressError` if the address does not become free soon."""
    host, port = server.get_host(), server.get_port()
    server.stop()
    deadline = time.monotonic() + _FREE_AGAIN_S
    while not is_free(host, port):
        if time.monotonic() > deadline:
            raise AddressError(f"Port {port} on {host} is not free any more; start again.")
        time.sleep(0.05)
    anew = _quietly(type(server), host, port, server.language, server.token)
    if stop.is_set() or anew.get_port() != port:  # another program was quicker
        anew.stop()
    if anew.get_port() != port:
        raise AddressError(f"Port {port} on {host} was taken meanwhile.")
    return anew


def _token(host: str, port: int, asked: bool) -> Token | None:
    return Token(port) if asked and not is_loopback(host) else None


def _quietly(
    kind: type[_Kind], host: str, port: int, language: PageLanguage, token: Token | None
) -> _Kind:
    # viser prints a banner with the address; our command line prints its own.
    with _viser_is_quiet():
        return kind(host, port, language=language, token=token, label="venus3d", verbose=False)
