"""Pieces of English shared by several modules' sentences."""

from __future__ import annotations

from collections.abc import Sequence


def listed(parts: Sequence[str], most: int | None = None) -> str:
    """ "a", "a and b", "a, b and c"; beyond `most` parts the rest is counted: "a, b and 4 more"."""
    if most is not None and len(parts) > most:
        parts = [*parts[: most - 1], f"{len(parts) - most + 1} more"]
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
