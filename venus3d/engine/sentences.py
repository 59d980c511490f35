"""Sentences that can be said in another language, and pieces shared by several modules.

The engine speaks English and knows no other language. It keeps with each sentence how it was made,
so that a page can make it again out of a translated template (`venus3d.languages`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


class Sentence(str):
    """An English text that remembers its template and arguments.

        TOO_NEAR = Sentence("{point} is too near: {value} mm from the lens.")
        TOO_NEAR.format(point=Sentence("The top edge"), value=150)

    Arguments that are sentences are translated as well. The template is a literal and a whole
    sentence where that is possible: other languages order and inflect words differently.
    """

    template: str
    arguments: Mapping[str, Any]

    def __new__(cls, template: str) -> Sentence:
        return cls._made(template, template, {})

    @classmethod
    def _made(cls, text: str, template: str, arguments: Mapping[str, Any]) -> Sentence:
        sentence = super().__new__(cls, text)
        sentence.template, sentence.arguments = template, arguments
        return sentence

    def format(self, *args: object, **arguments: object) -> Sentence:  # type: ignore[override]
        """The sentence with these named arguments."""
        return self._made(str.format(self.template, *args, **arguments), self.template, arguments)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (str(self), self.template, dict(self.arguments))


def _restored(text: str, template: str, arguments: Mapping[str, Any]) -> Sentence:
    return Sentence._made(text, template, arguments)  # pyright: ignore[reportPrivateUsage]


def said_by(error: BaseException) -> str:
    """What an error says: the sentence that it was raised with."""
    given = error.args[0] if len(error.args) == 1 else None
    return given if isinstance(given, str) else str(error)


MORE = Sentence("{count} more")
_THEN = Sentence("{before} {after}")
_NEXT, _LAST = Sentence("{parts}, {part}"), Sentence("{parts} and {part}")


def listed(parts: Sequence[str], most: int | None = None) -> str:
    """ "a", "a and b", "a, b and c"; beyond `most` parts the rest is counted: "a, b and 4 more"."""
    if most is not None and len(parts) > most:
        parts = [*parts[: most - 1], MORE.format(count=len(parts) - most + 1)]
    whole = parts[0]
    for part in parts[1:-1]:
        whole = _NEXT.format(parts=whole, part=part)
    return _LAST.format(parts=whole, part=parts[-1]) if len(parts) > 1 else whole


def after_each_other(sentences: Sequence[str]) -> str:
    """Whole sentences, one after the other."""
    whole = sentences[0]
    for sentence in sentences[1:]:
        whole = _THEN.format(before=whole, after=sentence)
    return whole


def with_commas(parts: Sequence[str]) -> str:
    """ "a", "a, b", "a, b, c"."""
    whole = parts[0]
    for part in parts[1:]:
        whole = _NEXT.format(parts=whole, part=part)
    return whole
