"""Texts and numbers in the language that is spoken now. What has no translation stays English; a
test sees to it that nothing is missing."""

from __future__ import annotations

import re
from collections.abc import Mapping
from string import Formatter
from typing import Any

from venus3d.engine.sentences import Sentence, said_by
from venus3d.languages.catalogue import sentences_of
from venus3d.languages.current import Language, current_language

_DECIMALS = re.compile(r"[-−+±]? ?\d+\.\d+( ± \d+\.\d+)?")
_COMMA: frozenset[Language] = frozenset({"de"})


def number(text: str) -> str:
    """A number as it is written in this language: "0.42" or "0,42"; other texts as they are."""
    comma = current_language() in _COMMA and _DECIMALS.fullmatch(text)
    return text.replace(".", ",") if comma else text


def translated(text: str) -> str:
    """An engine's sentence in this language, as plain text; other texts as they are."""
    language = current_language()
    if language == "en" or not isinstance(text, Sentence):
        return str(text)
    template = sentences_of(language).get(text.template, text.template)
    arguments = {
        name: translated(value) if isinstance(value, str) else value
        for name, value in text.arguments.items()
    }
    return filled(template, arguments) if arguments else template


def translated_error(error: BaseException) -> str:
    """What an error says, in this language."""
    return translated(said_by(error))


def filled(template: str, arguments: Mapping[str, Any]) -> str:
    """The template with its arguments, numbers written as in this language."""
    return _FORMATTER.vformat(template, (), arguments)


class Template(str):
    """A translated text whose numbers are written as in its language."""

    def format(self, *args: object, **arguments: object) -> str:  # type: ignore[override]
        """The text with these named arguments."""
        return filled(str(self), arguments)


class _Formatter(Formatter):
    def format_field(self, value: Any, format_spec: str) -> str:
        return number(super().format_field(value, format_spec))


_FORMATTER = _Formatter()
