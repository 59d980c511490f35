"""Labels move apart in the window, and only as far as they must."""

from __future__ import annotations

from itertools import combinations

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.render.label_places import HEIGHT_PX, places_apart
from venus3d.render.shapes import LabelShape
from venus3d.render.text_drawing import pill_picture
from venus3d.render.viewpoints import SceneCamera

WINDOW = (922, 1080)
VIEW = SceneCamera(np.array([-0.6, -0.5, -0.5]), np.array([0.0, 0.0, 0.4]), np.radians(42.0))


def pixels_of(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 2) where OpenCV sees points in this window."""
    ahead = (VIEW.look_at - VIEW.position) / np.linalg.norm(VIEW.look_at - VIEW.position)
    right = np.cross([0.0, 1.0, 0.0], ahead)
    right /= np.linalg.norm(right)
    R = np.stack([right, np.cross(ahead, right), ahead])
    f = WINDOW[1] / 2 / np.tan(VIEW.fov_rad / 2)
    K = np.array([[f, 0, WINDOW[0] / 2], [0, f, WINDOW[1] / 2], [0, 0, 1.0]])
    pixels, _ = cv2.projectPoints(points, cv2.Rodrigues(R)[0], -R @ VIEW.position, K, None)
    return np.asarray(pixels, np.float64).reshape(-1, 2)


def label(text: str, *at: float) -> LabelShape:
    return LabelShape(f"/labels/{text}", text, np.array(at), (255, 255, 255))


def test_no_label_covers_another_and_the_first_stays() -> None:
    rng = np.random.default_rng(3)
    for _ in range(100):
        labels = [
            label(text, *rng.normal([0, 0, 0.45], 0.03))
            for text in ("Target", "+33°", "X", "57 mm", "3 Swing about Y +10°")
        ]
        wanted = pixels_of(np.array([each.position for each in labels]))
        places = pixels_of(np.array(places_apart(labels, VIEW, WINDOW)))
        np.testing.assert_allclose(places[0], wanted[0], atol=1e-6)
        np.testing.assert_allclose(places[:, 0], wanted[:, 0], atol=1e-6)
        for i, j in combinations(range(len(labels)), 2):
            dx, dy = np.abs(places[i] - places[j])
            letters = 7.5 * (len(labels[i].text) + len(labels[j].text)) / 2
            assert dy >= HEIGHT_PX - 1e-3 or dx > letters


def test_a_label_leaves_the_tip_of_an_arrow_free() -> None:
    """A small window's label covered the head, which says where to."""
    rng = np.random.default_rng(5)
    moved = 0
    for _ in range(50):
        amount = label("−66°", *rng.normal([0, 0, 0.45], 0.02))
        tip = amount.position + rng.normal(0, 0.02, 3)
        (place,) = places_apart([amount], VIEW, WINDOW, [tip])
        at, head = pixels_of(np.array([place, tip]))
        pill = pill_picture(amount.text, amount.colour, 26)
        aside, above = np.abs(at - head)
        assert aside > pill.shape[1] / 2 or above > pill.shape[0] / 2
        moved += not np.allclose(place, amount.position)
    assert 5 < moved < 45, "only where it has to"


def test_a_label_leaves_an_arrow_free_where_that_is_near() -> None:
    """A step's word lay over the step's own arrow."""
    rng = np.random.default_rng(6)
    for _ in range(50):
        amount = label("Rotate", *rng.normal([0, 0, 0.45], 0.02))
        tail, tip = amount.position + rng.normal(0, 0.02, (2, 3))
        shaft = tail + np.linspace(0, 1, 20)[:, None] * (tip - tail)
        (place,) = places_apart([amount], VIEW, WINDOW, [tip], shaft)
        at, *along = pixels_of(np.array([place, *shaft]))
        aside, above = np.abs(at - along).T
        assert ((aside > 22) | (above > 13)).all()
    # A long arrow in the way of the label goes on below it: farther off it would not be its label.
    high = np.array([0.0, 0.0, 0.45]) + np.linspace(-0.2, 0.2, 200)[:, None] * [0, 1.0, 0]
    (place,) = places_apart([label("Rotate", 0, 0, 0.45)], VIEW, WINDOW, [], high)
    np.testing.assert_allclose(place, [0, 0, 0.45], atol=1e-9)


def test_a_caption_stays_where_it_is_as_wide_as_it_is() -> None:
    """Taken for wider than it is, a step's caption was moved onto another step's board."""
    # Beside each other, 2 px apart.
    f = WINDOW[1] / 2 / np.tan(VIEW.fov_rad / 2)
    texts = ("−66°", "4 Rotate −87°")
    half = [pill_picture(text, (0, 0, 0), 26).shape[1] / 2 for text in texts]
    first = np.array([0.0, 0.0, 0.4])
    depth = float(VIEW.axes[2] @ (first - VIEW.position))
    second = first + VIEW.axes[0] * (sum(half) + 2 + 4) * depth / f
    labels = [label(text, *at) for text, at in zip(texts, (first, second), strict=True)]
    np.testing.assert_allclose(places_apart(labels, VIEW, WINDOW), [first, second], atol=1e-9)


def test_labels_that_are_far_apart_and_those_behind_the_eye_stay() -> None:
    labels = [label("a", -0.1, 0, 0.5), label("b", 0.2, 0.1, 0.5), label("c", -2.0, -2.0, -2.0)]
    for shape, place in zip(labels, places_apart(labels, VIEW, WINDOW), strict=True):
        np.testing.assert_allclose(place, shape.position, atol=1e-9)


def test_a_label_at_the_window_s_edge_is_moved_inside() -> None:
    view, (width, height) = SceneCamera(np.zeros(3), np.array([0.0, 0.0, 1.0]), 1.0), (400, 300)
    focal = height / 2 / np.tan(0.5)
    at = np.array([0.98 * width / 2 / focal, 0.0, 1.0])
    label = LabelShape("/a", "Schwenken", at, (0, 0, 0))
    (place,) = places_apart([label], view, (width, height))
    x, y, z = view.axes @ place
    assert focal * x / z < width / 2 - 40 and abs(y) < 1e-9
    outside = LabelShape("/a", "Schwenken", 1.2 * at * [1, 1, 1 / 1.2], (0, 0, 0))
    np.testing.assert_allclose(places_apart([outside], view, (width, height))[0], outside.position)
