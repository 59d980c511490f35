"""The table of a language, as it is stored."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import msgspec

from venus3d.languages.current import Language

Section = dict[str, str]
"""English to the other language."""


@cache
def catalogue_of(language: Language) -> dict[str, Section]:
    """The sections of a language's table, by the file that they are about; none for English."""
    if language == "en":
        return {}
    path = Path(__file__).parent / f"{language}.toml"
    return msgspec.toml.decode(path.read_bytes(), type=dict[str, Section])


@cache
def sentences_of(language: Language) -> Section:
    """All entries on engine sentences, by their templates, whichever file they are from."""
    sections = catalogue_of(language)
    return {
        english: words
        for file, section in sections.items()
        if not file.endswith("texts.py")
        for english, words in section.items()
    }
