"""Adds scripts of this folder and a language to viser's page as it is served; viser has no option
for either."""

from __future__ import annotations

import gzip
from functools import cache, lru_cache
from pathlib import Path

from websockets.http11 import Response

from venus3d.languages import Language


def as_page(response: Response, names: tuple[str, ...], language: Language) -> Response:
    """The response, with the scripts of these names (`audience` for audience.js) and in this
    language if it is the page."""
    headers = response.headers
    if response.status_code != 200 or not headers.get("Content-Type", "").startswith("text/html"):
        return response
    body = _page_with(
        bytes(response.body), names, language, headers.get("Content-Encoding") == "gzip"
    )
    del headers["Content-Length"]
    headers["Content-Length"] = str(len(body))
    return Response(response.status_code, response.reason_phrase, headers, body)


@lru_cache(maxsize=8)
def _page_with(body: bytes, names: tuple[str, ...], language: Language, zipped: bool) -> bytes:
    page = gzip.decompress(body) if zipped else body
    page = page.replace(b'<html lang="en"', f'<html lang="{language}"'.encode(), 1)
    before, end, after = page.rpartition(b"</body>")
    scripts = b"".join(b"<script>" + _script(name) + b"</script>" for name in names)
    page = before + scripts + end + after
    return gzip.compress(page) if zipped else page


@cache
def _script(name: str) -> bytes:
    return (Path(__file__).parent / f"{name}.js").read_bytes()
