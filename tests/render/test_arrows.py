"""Arrows are closed, face outwards and point where they should: checked with trimesh."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from venus3d.render.arrows import arc_arrow, arc_point, straight_arrow


@pytest.mark.parametrize("length", [0.01, 0.3])
def test_a_straight_arrow_is_one_closed_body_from_foot_to_tip(length: float) -> None:
    arrow = straight_arrow(length, 0.004)
    assert arrow.is_watertight and arrow.volume > 0
    assert arrow.bounds[:, 2] == pytest.approx([0, length])
    tip = arrow.vertices[arrow.vertices[:, 2].argmax()]
    assert tip == pytest.approx([0, 0, length])


@pytest.mark.parametrize(("start", "end"), [(0, 40), (0, -60), (-10, 50), (20, -5)])
def test_an_arc_arrow_ends_at_its_angle_and_faces_outwards(start: float, end: float) -> None:
    arrow = arc_arrow(start, end, 0.2, 0.004)
    tip = arc_point(end, 0.2)
    assert np.linalg.norm(arrow.vertices - tip, axis=1).min() < 1e-9
    # Its three parts: the tube is open where the ball and the head close it.
    parts: Any = arrow.split(only_watertight=False)
    assert len(parts) == 3
    for part in parts:
        flat = part.vertices * [1, 1, 0]
        nearest = 0.2 * flat / np.linalg.norm(flat, axis=1, keepdims=True)
        to_middle = part.vertices - nearest
        facing = np.einsum("ij,ij->i", part.vertex_normals, to_middle)
        assert np.mean(facing > 0) > 0.9
