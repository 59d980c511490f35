"""Suggestions: every method and cost, what they say, and whether following them pays."""

from __future__ import annotations

import numpy as np
import pytest

from tests.engine.planning.suggestions import suggestion
from venus3d.engine.calibration.information import covariance_of, view_information
from venus3d.engine.calibration.observation import Observation, View
from venus3d.engine.calibration.projection_uncertainty import projection_uncertainty_px
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.heuristic_poses import HeuristicState
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.search_trace import SearchStep
from venus3d.engine.planning.settings import (
    COSTS,
    METHODS,
    Cost,
    Method,
    PlanningSettings,
    Start,
    Strategy,
)
from venus3d.engine.planning.suggest import NextTarget
from venus3d.engine.planning.target import reason_for

PARAMETERS = PAPER_CAMERA.parameter_names

SIGMA = float(np.sqrt(0.1))
FIRST = Pose.from_vector([45, 0, 0, 0, 0, 0.4])


def said_by(camera: Camera, board: Board, pose: Pose) -> Array:
    return view_information(camera, board.corners, pose.R[None], pose.t[None])[0]


def guided(
    camera: Camera, board: Board, method: Method, views: int, seed: int = 0
) -> tuple[Array, list[NextTarget]]:
    """The information after following the method's suggestions exactly, and the suggestions."""
    rng = np.random.default_rng(seed)
    information, state = said_by(camera, board, FIRST), None
    made: list[NextTarget] = []
    for number in range(2, views + 1):
        made.append(
            suggestion(
                board,
                camera,
                information,
                SIGMA,
                PlanningSettings(method=method),
                rng=rng,
                number=number,
                state=state,
            )
        )
        state = made[-1].state
        information = information + said_by(camera, board, made[-1].target.pose)
    return information, made


@pytest.mark.parametrize("method", METHODS)
def test_a_target_is_complete_and_within_the_limits(
    method: Method, paper_camera: Camera, default_board: Board
) -> None:
    _, made = guided(paper_camera, default_board, method, 6)
    for one in made:
        target = one.target
        assert Limits().accepts(paper_camera, default_board, target.pose.vector())[0]
        np.testing.assert_array_equal(target.steps[3].after.matrix, target.pose.matrix)
        assert target.method == method and target.search_s > 0
        assert 1 <= len(target.serves) <= 3 and set(target.serves) <= set(PARAMETERS)
        assert target.reason.endswith(".") and target.serves[0] in target.reason
        assert np.isfinite(target.predicted_sigma).all() and target.predicted_uncertainty_px > 0
        assert (target.evaluated > 0) == (method in ("venus", "global"))
    assert [s.target.number for s in made] == [2, 3, 4, 5, 6]


def test_the_prediction_is_what_the_view_brings(paper_camera: Camera, default_board: Board) -> None:
    information, made = guided(paper_camera, default_board, "global", 5)
    after = covariance_of(information, SIGMA)
    target = made[-1].target
    np.testing.assert_allclose(target.predicted_sigma, np.sqrt(np.diag(after)), rtol=1e-6)
    assert target.predicted_uncertainty_px == pytest.approx(
        projection_uncertainty_px(paper_camera, after)
    )


def test_searching_the_whole_space_beats_the_rules(
    paper_camera: Camera, default_board: Board
) -> None:
    """After six views: the whole space far below the paper's and Rojtberg's rules."""
    error = {
        method: projection_uncertainty_px(
            paper_camera, covariance_of(guided(paper_camera, default_board, method, 6)[0], SIGMA)
        )
        for method in METHODS
    }
    assert error["global"] < 0.7
    assert error["global"] < 0.6 * min(error[m] for m in METHODS if m != "global")


@pytest.mark.parametrize("cost", COSTS)
@pytest.mark.parametrize("method", ["venus", "global"])
def test_every_cost_that_makes_sense(
    method: Method, cost: Cost, paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    poses = [
        FIRST,
        Pose.from_vector([-30, 20, 0, 0, 0, 0.4]),
        Pose.from_vector([0, -35, 5, 0, 0, 0.4]),
    ]
    ids = np.arange(default_board.corner_count)
    views: list[View] = []
    for i, pose in enumerate(poses):
        pixels = paper_camera.project(pose.apply(default_board.corners))
        noise = rng.normal(0, SIGMA, pixels.shape)
        seen = Observation(ids, pixels + noise, paper_camera.image_size)
        views.append(View(i + 1, seen, pose, SIGMA, noise))
    information = sum(said_by(paper_camera, default_board, pose) for pose in poses)
    moves: list[SearchStep] = []

    def ask() -> NextTarget:
        return suggestion(
            default_board,
            paper_camera,
            information,  # type: ignore[arg-type]
            SIGMA,
            PlanningSettings(method=method, cost=cost),
            rng=rng,
            number=4,
            views=views,
            on_step=moves.append,
            # Real calibrations take their time; a few show that it works.
            stop=(lambda: len(moves) >= 8) if cost == "rms" else None,
        )

    if method == "global" and cost == "rms":
        with pytest.raises(VenusError, match="too slow for the method global"):
            ask()
        return
    target = ask().target
    assert target.cost == cost and moves and target.evaluated >= 9


@pytest.mark.parametrize(
    ("method", "cost", "words"),
    [
        ("random", "sum-iod", "random does not search"),
        ("pose-selection", "rms", "pose-selection does not search"),
        ("guess", None, "no method 'guess'; use one of random"),
        ("global", "beauty", "no cost 'beauty'; use one of projection-variance"),
    ],
)
def test_combinations_without_sense_are_told(
    method: Method, cost: Cost, words: str, paper_camera: Camera, default_board: Board
) -> None:
    with pytest.raises(VenusError, match=words):
        suggestion(
            default_board,
            paper_camera,
            np.eye(9),
            1.0,
            PlanningSettings(method=method, cost=cost),
            rng=np.random.default_rng(0),
            number=1,
        )


@pytest.mark.parametrize("limits", [Limits(), {"near": 0.35}])
def test_limits_are_fields_of_limits(limits: object) -> None:
    with pytest.raises(VenusError, match="a dictionary of fields of Limits"):
        PlanningSettings(limits=limits)  # type: ignore[arg-type]


@pytest.mark.parametrize("method", METHODS)
def test_a_skipped_pose_is_not_offered_again_nearby(
    method: Method, paper_camera: Camera, default_board: Board
) -> None:
    information = said_by(paper_camera, default_board, FIRST)
    skipped: list[Pose] = []
    state = HeuristicState()
    for number in range(2, 8):
        made = suggestion(
            default_board,
            paper_camera,
            information,
            SIGMA,
            PlanningSettings(method=method),
            rng=np.random.default_rng(3),
            number=number,
            state=state,
            skipped=skipped,
        )
        state, pose = made.state, made.target.pose
        for old in skipped:
            near = pose.distance_to(old) < 0.1 * np.linalg.norm(old.t)
            assert not (near and pose.angle_to_deg(old) < 15)
        skipped.append(pose)


def test_a_distortion_that_folds_within_the_image_does_not_stop_the_planning(
    default_board: Board,
) -> None:
    """After two views k1 ... k3 may be absurd; a target must be found all the same."""
    absurd = Camera(1280, 720, 1068, 1073, 635, 355, k1=-1.5)
    assert absurd.radius_limit < 0.5  # the image reaches to 0.68
    target = suggestion(
        default_board,
        absurd,
        said_by(absurd.without_distortion(), default_board, FIRST),
        SIGMA,
        rng=np.random.default_rng(0),
        number=2,
    ).target
    assert np.isfinite(target.predicted_uncertainty_px)


def test_one_frontal_view_leaves_the_search_on_its_feet(
    paper_camera: Camera, default_board: Board
) -> None:
    frontal = Pose.from_vector([0, 0, 0, 0, 0, 0.4])
    target = suggestion(
        default_board,
        paper_camera,
        said_by(paper_camera, default_board, frontal),
        SIGMA,
        rng=np.random.default_rng(0),
        number=2,
    ).target
    # What a frontal view cannot show is the focal length, so the next one is tilted.
    assert target.serves[0] in ("fx", "fy")
    assert np.degrees(np.arccos(target.pose.R[2, 2])) > 15


@pytest.mark.parametrize(
    ("serves", "vector", "sentence"),
    [
        (
            ("fy",),
            [40, 0, 0, 0, 0, 0.4],
            "Tilting the board about X makes one side look smaller, and that shows the vertical "
            "focal length (fy).",
        ),
        (
            ("k3", "k2"),
            [0, 0, 0, -0.28, -0.14, 0.73],
            "The board in the top left corner of the picture, where the lens bends most, shows how "
            "the lens bends straight lines (k2, k3).",
        ),
        (
            ("cx", "fx", "p1"),
            [0, 35, 0, 0, 0, 0.5],
            "Tilting the board about Y makes one side look smaller, and that shows where the lens "
            "points, left to right (cx), the horizontal focal length (fx) and how the lens bends "
            "straight lines (p1).",
        ),
        (
            ("p1",),
            [0, 0, 0, 0, 0, 0.27],
            "A board over most of the picture shows how the lens bends straight lines (p1).",
        ),
    ],
)
def test_the_reason_in_words(
    serves: tuple[str, ...],
    vector: list[float],
    sentence: str,
    paper_camera: Camera,
    default_board: Board,
) -> None:
    assert reason_for(serves, Pose.from_vector(vector), paper_camera, default_board) == sentence


def test_nothing_is_said_of_a_generated_pose_that_was_not_used(
    paper_camera: Camera, default_board: Board
) -> None:
    information = view_information(
        paper_camera,
        default_board.corners,
        *(np.stack(part) for part in zip(*((p.R, p.t) for p in _VIEWED), strict=True)),
    ).sum(axis=0)

    def note(start: Start, strategy: Strategy) -> str:
        return suggestion(
            default_board,
            paper_camera,
            information,
            0.3,
            PlanningSettings(
                method="venus", start=start, strategy=strategy, limits={"max_tilt_deg": 20.0}
            ),
            rng=np.random.default_rng(0),
            number=4,
        ).note

    assert "beyond 20°" in note("generated", "annealing")
    assert note("random", "annealing") == ""
    assert note("generated", "global") == ""


_VIEWED = [
    Pose.from_vector(v)
    for v in ([40, 0, 0, 0, 0, 0.4], [0, -40, 10, 0.05, 0, 0.4], [-30, 30, 0, 0, 0.03, 0.5])
]
