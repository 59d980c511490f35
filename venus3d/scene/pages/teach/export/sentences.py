"""A pose or a step in plain sentences for exported files, without zeros."""

from __future__ import annotations

from venus3d.scene.pages.teach.export import texts
from venus3d.scene.pages.teach.state import Vector


def pose_sentence(vector: Vector) -> str:
    """The six numbers, degrees and millimetres, in words."""
    turns = [
        text.format(amount=f"{angle:+g}".replace("-", "−"))
        for text, angle in zip(texts.TURNS, vector[:3], strict=True)
        if angle
    ]
    places = [
        sides[length < 0].format(amount=f"{abs(length):g}")
        for sides, length in zip(texts.PLACES, vector[3:5], strict=True)
        if length
    ]
    places = [*(places or [texts.AHEAD]), texts.AWAY.format(amount=f"{vector[5]:g}")]
    turned = texts.TURNED.format(turns=_listed(turns)) if turns else texts.NOT_TURNED
    return f"{turned} {texts.PLACED.format(places=_listed(places))}"


def _listed(parts: list[str]) -> str:
    return texts.AND.join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)
