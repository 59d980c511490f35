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
    """All entries by their English, for sentences, which do not know their file. The engine's go
    before equal words on a page."""
    sections = catalogue_of(language)
    found: Section = {}
    for file in sorted(sections, key=lambda file: not file.endswith("texts.py")):
        found |= sections[file]
    return found
