"""The token of a page that other machines can reach: who has it may enter.

It stands in the printed address. The first request exchanges it for a cookie and is sent on to the
address without it, so that it stays in no address bar, history or projected window.
"""

from __future__ import annotations

import hmac
import secrets
from http import HTTPStatus
from urllib.parse import parse_qs, urlsplit

from websockets import Headers
from websockets.http11 import Request, Response

from venus3d.scene.web.handshake import RefusedError

_BYTES = 16
"""128 bits: not to be guessed, and short enough to type."""


class Token:
    """A secret that a browser must show."""

    def __init__(self, port: int) -> None:
        """A new secret, for the server on this port (a machine's ports share their cookies)."""
        self.secret = secrets.token_urlsafe(_BYTES)
        self._cookie = f"venus3d-{port}"

    def check(self, request: Request) -> Response | None:
        """The answer that gives a browser its cookie, or None: it may enter. A program may show the
        token in the websocket's address. Raises `RefusedError` for whoever has neither."""
        shown = parse_qs(urlsplit(request.path).query).get("token", [])
        if len(shown) == 1 and self._is_secret(shown[0]):
            return None if "upgrade" in request.headers else self._cookie_given()
        if not any(self._is_secret(one) for one in self._cookies(request.headers)):
            raise RefusedError(
                "This page needs its token; open it by the address that the program printed, which "
                "has the token in it."
            )
        return None

    def _is_secret(self, shown: str) -> bool:
        return hmac.compare_digest(shown.encode(errors="replace"), self.secret.encode())

    def _cookies(self, headers: Headers) -> list[str]:
        # http.cookies gives up at what other programs of this machine put into theirs.
        parts = [
            part.partition("=") for line in headers.get_all("cookie") for part in line.split(";")
        ]
        return [value.strip() for name, _, value in parts if name.strip() == self._cookie]

    def _cookie_given(self) -> Response:
        # Lax, not Strict: a printed address is also opened from a mail or a chat.
        cookie = (f"{self._cookie}={self.secret}", "path=/", "httponly", "samesite=lax")
        headers = Headers(
            {
                "location": "/",
                "set-cookie": "; ".join(cookie),
                "content-length": "0",
                "cache-control": "no-store",
            }
        )
        return Response(HTTPStatus.SEE_OTHER, HTTPStatus.SEE_OTHER.phrase, headers, b"")
