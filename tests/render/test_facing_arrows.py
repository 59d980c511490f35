"""An arrow along the line of sight is drawn bent and flat, facing the eye, and means the same."""

from __future__ import annotations

import numpy as np
import pytest

from venus3d.render.arrows import frame_along, straight_arrow
from venus3d.render.facing_arrows import facing
from venus3d.render.shapes import MeshShape
from venus3d.render.viewpoints import SceneCamera

TAIL, LENGTH = np.array([0.05, -0.02, 0.6]), 0.3


def arrow_along(direction: np.ndarray) -> MeshShape:
    ends = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, LENGTH]])
    mesh = straight_arrow(LENGTH, 0.004)
    return MeshShape("/a", mesh, frame_along(direction, TAIL), on_top=True, ends=ends)


def seen_from(arrow: MeshShape, off_deg: float, *, from_ahead: bool) -> SceneCamera:
    """A view that meets the arrow's middle at this angle."""
    middle = arrow.pose.apply(np.array([0.0, 0.0, LENGTH / 2]))
    way = arrow.pose.R @ [np.sin(np.radians(off_deg)), 0.0, np.cos(np.radians(off_deg))]
    return SceneCamera(middle + (1.5 if from_ahead else -1.5) * way, middle, 0.8)


def in_window(view: SceneCamera, shape: MeshShape, points: np.ndarray) -> np.ndarray:
    return view.in_window(shape.pose.apply(points), 1.0)


@pytest.mark.parametrize("direction", [[0, 0, 1], [0.3, -0.8, 0.2], [-1, 0.1, -0.4]])
@pytest.mark.parametrize("from_ahead", [True, False])
def test_it_is_used_within_twenty_degrees_and_points_the_same_way(
    direction: list[float], from_ahead: bool
) -> None:
    arrow = arrow_along(np.array(direction, dtype=np.float64))
    far_off = seen_from(arrow, 22, from_ahead=from_ahead)
    assert facing(arrow, far_off) is arrow
    view = seen_from(arrow, 15, from_ahead=from_ahead)
    bent = facing(arrow, view)
    assert isinstance(bent, MeshShape)
    assert bent is not arrow
    assert bent is facing(arrow, view), "nothing is sent again"
    vertices = np.asarray(bent.mesh.vertices)
    depths = (bent.pose.apply(vertices) - view.position) @ view.axes[2]
    assert np.ptp(depths) < 1e-9, "it faces the eye"
    spread = np.ptp(in_window(view, bent, vertices), axis=0)
    plain = np.ptp(in_window(view, arrow, np.asarray(arrow.ends)), axis=0)
    assert spread.max() > 0.25 > plain.max(), "readable"
    tip, middle = vertices[-1], vertices[:-3].mean(axis=0)
    true = np.diff(in_window(view, arrow, np.asarray(arrow.ends)), axis=0)[0]
    shown = in_window(view, bent, np.stack([-tip, tip]))
    along = (shown[1] - shown[0]) @ true / np.linalg.norm(shown[1] - shown[0])
    assert along / np.linalg.norm(true) > 0.99, "towards where the tip appears"
    assert middle[1] > 0.02
    # Wider at the end that is nearer to the eye.
    count = (len(vertices) - 3) // 2
    widths = np.linalg.norm(vertices[:count] - vertices[count : 2 * count], axis=1)
    assert (widths[-1] > widths[0]) == from_ahead


def test_what_is_no_arrow_stays_as_it_is() -> None:
    arrow = arrow_along(np.array([0.0, 0.0, 1.0]))
    view = seen_from(arrow, 0, from_ahead=False)
    plain = MeshShape("/b", arrow.mesh, arrow.pose)
    assert facing(plain, view) is plain
    assert facing(arrow, view) is not arrow, "even exactly along it"
