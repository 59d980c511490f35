"""Text of strangers, such as file names, made safe to print."""

from __future__ import annotations

import unicodedata

_UNSEEN = {"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"}
"""Unicode's categories of what a terminal obeys, or what nobody sees."""


def is_seen(character: str) -> bool:
    """Whether a character is drawn: not a control, direction or half of a surrogate pair."""
    return unicodedata.category(character) not in _UNSEEN


def printable(text: str) -> str:
    """The text with control characters, all but line ends and tabs, written as \\x1b is."""
    return "".join(
        one if is_seen(one) or one in "\n\t" else one.encode("unicode_escape").decode()
        for one in text
    )
