"""Text of strangers, such as file names, made safe to print."""

from __future__ import annotations

import re
import unicodedata

_UNSEEN = {"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"}
"""Unicode's categories of what a terminal obeys, or what nobody sees."""

_IN_DOUBT = re.compile(r"[^\n\t -~]")


def is_seen(character: str) -> bool:
    """Whether a character is drawn: not a control, direction or half of a surrogate pair."""
    return unicodedata.category(character) not in _UNSEEN


def printable(text: str) -> str:
    """The text with control characters, all but line ends and tabs, written as \\x1b is."""
    return _IN_DOUBT.sub(lambda found: _as_text(found[0]), text)


def _as_text(one: str) -> str:
    return one if is_seen(one) else one.encode("unicode_escape").decode()
