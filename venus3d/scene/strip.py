"""All four steps side by side, for teaching: each with its board before and after, and its arrow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from venus3d.engine.board import Board
from venus3d.engine.camera import Camera
from venus3d.engine.decomposition import Step
from venus3d.scene.shapes import Shape

if TYPE_CHECKING:
    from venus3d.scene.describe import SceneOptions


def strip_shapes(
    board: Board, camera: Camera, steps: Sequence[Step], options: SceneOptions
) -> list[Shape]:
    return []
