"""The language that is spoken now, by the code that draws a page."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache, wraps
from typing import Literal, ParamSpec, TypeVar, get_args

Language = Literal["en", "de"]
"""A language's code, as in HTML."""
LANGUAGES: tuple[Language, ...] = get_args(Language)

_Given = ParamSpec("_Given")
_Made = TypeVar("_Made")


class PageLanguage:
    """The language of one page. It may change; threads that speak for the page notice that."""

    def __init__(self, chosen: Language | None = None) -> None:
        """English, until a browser asks for another; always `chosen` if that is given."""
        self.code: Language = chosen or "en"
        self.is_open = chosen is None
        """Whether a browser may still choose."""

    @contextmanager
    def spoken(self) -> Generator[None, None, None]:
        """Speak it meanwhile, on this thread."""
        before = _SPOKEN.set(self)
        try:
            yield
        finally:
            _SPOKEN.reset(before)


_SPOKEN: ContextVar[PageLanguage | None] = ContextVar("language", default=None)


def current_language() -> Language:
    """The language spoken now; English where no page speaks."""
    page = _SPOKEN.get()
    return "en" if page is None else page.code


def cached_by_language(
    maxsize: int,
) -> Callable[[Callable[_Given, _Made]], Callable[_Given, _Made]]:
    """As `functools.lru_cache`, for functions whose results have texts in the language spoken."""

    def decorate(make: Callable[_Given, _Made]) -> Callable[_Given, _Made]:
        @lru_cache(maxsize=maxsize)
        def cached(_: Language, *given: _Given.args, **more: _Given.kwargs) -> _Made:
            return make(*given, **more)

        @wraps(make)
        def called(*given: _Given.args, **more: _Given.kwargs) -> _Made:
            return cached(current_language(), *given, **more)

        return called

    return decorate


def language_from(accepted: str) -> Language:
    """The first language that a browser prefers and that exists; English for none.

    Args:
        accepted: the header Accept-Language, such as "de-CH,de;q=0.9,en;q=0.8" (RFC 9110, 12.5.4).
    """
    wishes: list[tuple[float, Language]] = []
    for part in accepted.split(","):
        name, _, quality = part.partition(";")
        try:
            share = float(quality.strip().removeprefix("q=") or 1)
        except ValueError:
            continue
        code = name.strip().lower().partition("-")[0]
        for known in LANGUAGES:
            if code == known and share > 0:
                wishes.append((-share, known))
    return min(wishes, key=lambda wish: wish[0], default=(0.0, LANGUAGES[0]))[1]
