"""The languages of the pages. The command line, logs and files speak English.

A page has a `PageLanguage`; whoever draws or words something for it does so while it is spoken:

    with page.language.spoken():
        say.CAPTURE                     # a text of a module of texts: by itself
        translated(prompt.holder)       # an engine's sentence
        number(f"{rms:.2f}")            # a number that stands in no sentence

English is in the code, other languages are in a table each (`de.toml`): a section for each file,
English on the left. How a language is added: CONTRIBUTING.md.
"""

from venus3d.languages.catalogue import catalogue_of
from venus3d.languages.current import (
    LANGUAGES,
    Language,
    PageLanguage,
    cached_by_language,
    current_language,
    language_from,
)
from venus3d.languages.translation import number, translated, translated_error

__all__ = [
    "LANGUAGES",
    "Language",
    "PageLanguage",
    "cached_by_language",
    "catalogue_of",
    "current_language",
    "language_from",
    "number",
    "translated",
    "translated_error",
]
