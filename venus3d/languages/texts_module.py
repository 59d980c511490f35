"""Lets a module of texts answer in the language that is spoken now.

Its constants are written in English. `speak(__name__)`, below them, makes `texts.CAPTURE` look
itself up in the current language's table, and constants that are tuples or mappings do so for each
text in them. So constants are read where a page is drawn, as attributes of the module, and never
when another module is loaded (tests/languages holds that).
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import cache
from types import ModuleType
from typing import Any, cast

from venus3d.engine.sentences import Sentence
from venus3d.languages.catalogue import catalogue_of
from venus3d.languages.current import Language, current_language
from venus3d.languages.translation import Template


def speak(module: str) -> None:
    """Make the module of this name speak."""
    sys.modules[module].__class__ = _Texts


def section_of(module: str) -> str:
    """The section of the tables that is about a module: its file."""
    return module.removeprefix("venus3d.").replace(".", "/") + ".py"


class _Texts(ModuleType):
    def __getattribute__(self, name: str) -> Any:
        language = current_language() if name.isupper() else "en"
        if language == "en":
            return super().__getattribute__(name)
        return _in_language(super().__getattribute__("__name__"), name, language)


@cache
def _in_language(module: str, name: str, language: Language) -> Any:
    section = catalogue_of(language).get(section_of(module), {})
    return _translated(vars(sys.modules[module])[name], section)


def _translated(value: Any, section: Mapping[str, str]) -> Any:
    if isinstance(value, Sentence):  # translated with its arguments
        return value
    if isinstance(value, str):
        words = section.get(value, value)
        # Only what is formatted first: viser's messages take no other kind of text than str.
        return Template(words) if "{" in words else words
    if isinstance(value, dict):
        pairs = cast(dict[Any, Any], value)
        return {key: _translated(inner, section) for key, inner in pairs.items()}
    if isinstance(value, tuple):
        return tuple(_translated(inner, section) for inner in cast(tuple[Any, ...], value))
    return value
