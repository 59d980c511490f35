"""Tables 1 to 3: pools with known answers, OpenCV's own errors, a hand whose time is known."""

from __future__ import annotations

from dataclasses import fields, replace
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest

from venus3d.cli import main
from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import home_pose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.study.clip import PIXELS, load_clip
from venus3d.study.hand import (
    HELPS,
    Assumptions,
    Help,
    Motion,
    mirrored_tilt,
    motion_s,
    reach,
)
from venus3d.study.pool import (
    FEWEST_TEST,
    FEWEST_TRAINING,
    ViewPool,
    asking_limits,
    distance,
    distinct,
    nearest,
    pool_of,
    simulated_pool,
    split,
)
from venus3d.study.table1 import (
    ARMS,
    Arm,
    Table1Trial,
    guide_through,
    rms_of_views_px,
    run_table1,
    table1_text,
    table1_trials,
)
from venus3d.study.table2 import GUIDANCES, run_table2, table2_rows, table2_text
from venus3d.study.table3 import (
    PAPER_S,
    reduction,
    run_table3,
    table3_text,
    table3_trials,
    targets_of,
)

NOISE_PX = np.sqrt(0.1)
STILLS = Board(8, 8, 0.0254, 0.01905, "DICT_4X4_1000")
STILLS_OPTIONS = (
    *("--board.columns", "8", "--board.rows", "8", "--board.square-mm", "25.4"),
    *("--board.marker-mm", "19.05", "--board.dictionary", "DICT_4X4_1000"),
)


@pytest.fixture(scope="module")
def poses(paper_camera: Camera, default_board: Board) -> list[Pose]:
    space = Space(default_board, paper_camera, Limits.for_board(default_board, paper_camera))
    rng = np.random.default_rng(3)
    return [Pose.from_vector(random_pose(space, rng)) for _ in range(24)]


@pytest.fixture(scope="module")
def pool(paper_camera: Camera, default_board: Board, poses: list[Pose]) -> ViewPool:
    """Views at known poses, corners with the paper's noise."""
    rng = np.random.default_rng(4)
    views = tuple(_view(paper_camera, default_board, pose, rng) for pose in poses)
    return ViewPool("synthetic", default_board, views, len(views))


def _view(camera: Camera, board: Board, pose: Pose, rng: np.random.Generator) -> Observation:
    pixels, _ = cv2.projectPoints(board.corners, pose.rvec, pose.t, camera.K, camera.distortion)
    corners = pixels.reshape(-1, 2) + NOISE_PX * rng.standard_normal((board.corner_count, 2))
    return Observation(np.arange(board.corner_count), corners, camera.image_size, 0.5)


# -- table 1 --------------------------------------------------------------------------------------


def test_nearest_is_the_view_at_that_pose(
    pool: ViewPool, poses: list[Pose], paper_camera: Camera
) -> None:
    limits = Limits.for_board(pool.board, paper_camera)
    everything = range(len(poses))
    for index, pose in list(enumerate(poses))[::4]:
        beside = pose.turned("x", 3.0).moved([0.004, -0.003, 0.005])
        found = nearest(beside, pool, everything, paper_camera, limits)
        assert found is not None and found[0] == index
        assert found[1].angle_to_deg(pose) < 3
        others = [i for i in everything if i != index]
        other = nearest(beside, pool, others, paper_camera, limits)
        assert other is not None and other[0] != index


def test_nearness_sees_a_tilt_that_hardly_moves_a_corner(paper_camera: Camera) -> None:
    """Forwards and backwards cover nearly the same pixels; their poses are far apart."""
    limits = Limits()
    forwards = Pose.from_vector([40, 0, 0, 0, 0, 0.8])
    backwards = Pose.from_vector([-40, 0, 0, 0, 0, 0.8])
    shifted = forwards.moved([0.1, 0, 0])
    assert distance(forwards, forwards, paper_camera, limits) == 0
    near = distance(forwards, shifted, paper_camera, limits)
    assert distance(forwards, backwards, paper_camera, limits) > 3 * near
    # 0.1 m at 0.8 m by a focal length of 1068 px, of a width of 1280 px.
    assert near == pytest.approx(0.1 / 0.8 * 1068 / 1280, rel=1e-6)


@pytest.mark.parametrize("count", [10, 16, 40, 161])
def test_split_holds_views_out(count: int) -> None:
    splits = [split(count, np.random.default_rng(seed)) for seed in range(6)]
    for training, held_out in splits:
        assert sorted(training + held_out) == list(range(count))
        assert len(training) >= FEWEST_TRAINING and len(held_out) >= FEWEST_TEST
    assert len({held_out for _, held_out in splits}) > 1
    assert splits[2] == split(count, np.random.default_rng(2))


def test_repeats_blur_and_cut_boards_are_left_out(pool: ViewPool) -> None:
    first, second, *_ = pool.observations
    repeat = replace(first, corners=first.corners + 1.0)
    blurred = replace(pool.observations[2], sharpness=0.1)
    part = replace(second, ids=second.ids[:10], corners=second.corners[:10])
    kept = distinct([first, second, repeat, blurred, part], pool.board)
    assert len(kept) == 2 and kept[0] is first and kept[1] is second


def test_asking_limits_hold_the_recording(pool: ViewPool, poses: list[Pose]) -> None:
    asking = asking_limits(pool.board, pool.observations)
    for pose in poses:
        tilt = np.degrees(np.arccos(pose.R[:, 2] @ pose.t / np.linalg.norm(pose.t)))
        assert np.abs(pose.vector()[:3]).max() <= asking["max_angle_deg"] + 0.5
        assert tilt <= asking["max_tilt_deg"] + 0.5
        assert asking["nearest"] < pose.t[2] < asking["farthest"]


@pytest.mark.parametrize("arm", ARMS)
def test_held_out_views_are_never_used(pool: ViewPool, arm: Arm) -> None:
    training, held_out = split(len(pool.observations), np.random.default_rng(5))
    taken, ending = guide_through(pool, training, arm, seed=5, max_views=7)
    used = [step.index for step in taken]
    assert len(set(used)) == len(used) <= 7
    assert not set(used) & set(held_out) and set(used) <= set(training)
    assert ending == "converged" or len(used) == 7
    assert [len(step.calibration.views) for step in taken] == list(range(1, len(used) + 1))
    # With seven views of the simulated camera every method knows it roughly.
    assert taken[-1].calibration.camera.fx == pytest.approx(1068, abs=25)


def test_pool_that_runs_out_is_said(pool: ViewPool) -> None:
    taken, ending = guide_through(pool, (0, 1, 2, 3), "opencv", seed=0)
    assert ending == "pool empty" and len(taken) == 4


def test_rms_of_held_out_views_is_opencvs(pool: ViewPool, paper_camera: Camera) -> None:
    camera = calibrate(pool.board, pool.observations[:8]).camera
    indices = range(8, 20)
    squares: list[float] = []
    for index in indices:
        view = pool.observations[index]
        _, rvec, tvec = cv2.solvePnP(pool.board.corners, view.corners, camera.K, camera.distortion)
        pixels, _ = cv2.projectPoints(pool.board.corners, rvec, tvec, camera.K, camera.distortion)
        squares += list(((pixels.reshape(-1, 2) - view.corners) ** 2).sum(axis=1))
    expected = np.sqrt(np.mean(squares))
    assert rms_of_views_px(camera, pool, indices) == pytest.approx(expected, rel=1e-5)
    # And a good camera's is the noise of both coordinates, less what six parameters a pose take.
    best = rms_of_views_px(paper_camera, pool, indices)
    assert best == pytest.approx(NOISE_PX * np.sqrt(2 * (1 - 6 / 80)), rel=0.08)


def test_camera_that_explains_no_view_gets_no_better_for_it(pool: ViewPool) -> None:
    far_off = Camera(1280, 720, 300, 3000, 100, 700)
    assert rms_of_views_px(far_off, pool, range(6)) > 20


@pytest.mark.slow
def test_table1_on_real_stills(shared_data: Path) -> None:
    pool = pool_of(str(shared_data / "lifecam-charuco-8x8"), STILLS)
    assert len(pool.observations) == pool.frames == 16
    trials = [t for t in table1_trials([pool], 2, 0, 0.3, 40) if t.arm != "pose-selection"]
    rows = [row for trial in trials for row in run_table1(trial)]
    again = run_table1(trials[0])
    assert [row["view"] for row in rows[: len(again)]] == [row["view"] for row in again]
    for trial in trials:
        mine = [r for r in rows if (r["method"], r["seed"]) == (trial.arm, trial.seed)]
        assert [bool(r["ended"]) for r in mine] == [False] * (len(mine) - 1) + [True]
        assert 0.1 < float(mine[-1]["rms_test_px"]) < 1
        assert float(mine[-1]["fx"]) == pytest.approx(1127, abs=40)
    text = table1_text(rows, [pool])
    assert "0.6225, 9.0, 0.4377" in text and "2 seeds" in text


@pytest.mark.slow
def test_simulated_pool_shows_the_camera_that_took_it(
    paper_camera: Camera, default_board: Board
) -> None:
    pool = simulated_pool(default_board, np.random.default_rng(0), count=14)
    assert pool.name == "sim" and pool.truth == paper_camera
    assert len(pool.observations) >= FEWEST_TRAINING + FEWEST_TEST
    assert rms_of_views_px(paper_camera, pool, range(len(pool.observations))) < 0.2
    last = run_table1(Table1Trial(pool, "global", 0, max_views=6))[-1]
    assert 0 < float(last["true_error_px"]) < 3


def test_trials_have_their_own_keys(pool: ViewPool) -> None:
    trials = table1_trials([pool], 3, 0, 0.3, 40)
    assert len({trial.key for trial in trials}) == len(trials) == 3 * len(ARMS)
    assert isinstance(trials[0], Table1Trial)


# -- table 2 --------------------------------------------------------------------------------------


@pytest.mark.slow
def test_table2_measures_every_way_on_every_frame(shared_data: Path) -> None:
    clip = load_clip(str(shared_data / "lifecam-charuco-8x8"), STILLS, most=4)
    assert len(clip.images) == 4 and all(image.shape == (720, 1280, 3) for image in clip.images)
    before = [image.copy() for image in clip.images]
    costs = run_table2(clip, frames=5, threads=1, seed=0)
    assert all((costs.guiding_ms[way][:, 0] > 0).all() for way in GUIDANCES)
    assert all(np.array_equal(a, b) for a, b in zip(before, clip.images, strict=True))
    rows = table2_rows(costs)
    assert len(rows) == 5 * len(GUIDANCES) and {row["way"] for row in rows} == set(GUIDANCES)
    text = table2_text(costs)
    assert "38.46 ms" in text and "5 measurements" in text
    # The delay in a second is what 25 frames cost.
    line = next(line for line in text.splitlines() if "live detection and axes" in line)
    middle = float(np.median(costs.guiding_ms["axes"][:, 0]))
    assert f"{middle * 25 / 1000:.3f}" in line


@pytest.mark.parametrize("size", [(640, 480), (1920, 1080), (1280, 720)])
def test_frames_of_another_size_are_scaled_to_720p(
    tmp_path: Path, default_board: Board, size: tuple[int, int]
) -> None:
    picture = np.full((size[1], size[0]), 200, np.uint8)
    texture = default_board.texture(size[1] // 9)
    picture[20 : 20 + texture.shape[0], 30 : 30 + texture.shape[1]] = texture
    cv2.imwrite(str(tmp_path / "board.png"), picture)
    clip = load_clip(str(tmp_path), default_board)
    height, width = clip.images[0].shape[:2]
    assert width * height == pytest.approx(PIXELS, rel=0.01)
    assert width / height == pytest.approx(size[0] / size[1], rel=0.01)
    assert clip.observations[0].count == default_board.corner_count
    assert bool(clip.notes) == (size != (1280, 720))


# -- table 3 --------------------------------------------------------------------------------------

ERRORS = {
    f.name: 0.0 for f in fields(Assumptions) if f.name.endswith(("_share", "_deg", "_mm", "_flip"))
}
PERFECT_HAND = replace(Assumptions(), **ERRORS)


def _attempt(help_: Help, start: Pose, target: Pose, camera: Camera, board: Board):
    return reach(start, target, help_, PERFECT_HAND, camera, board, np.random.default_rng(0))


def test_perfect_hand_needs_the_time_of_its_parts(
    paper_camera: Camera, default_board: Board
) -> None:
    """A shift of 0.15 m, a turn of 40 degrees about X and one of 30 about Z; nothing goes wrong."""
    start, a = home_pose(), PERFECT_HAND
    target = Pose.from_vector([40, 0, 30, 0.1, 0.05, 0.6])
    shift = np.linalg.norm([0.1, 0.05, 0.1])
    # The tolerance of a step is 3.5 % of the board's shorter side of 168 mm, and 2.5 degrees.
    move_s = max(0.2 + 0.2 * np.log2(2 * shift / (2 * 0.035 * 0.168)), 1.875 * shift / 0.25)
    turns_s = [max(0.2 + 0.2 * np.log2(2 * t / 5.0), 1.875 * t / 45) for t in (40, 30)]
    steps = _attempt("steps", start, target, paper_camera, default_board)
    assert steps.reached and steps.looks == 3
    expected = move_s + sum(turns_s) + 3 * (a.reaction_s + a.reading_s)
    assert steps.seconds == pytest.approx(expected, abs=1e-9)
    one = start.angle_to_deg(target)
    at_once_s = max(0.2 + 0.2 * np.log2(2 * one / 5.0), 1.875 * one / 45)
    perfect = _attempt("perfect", start, target, paper_camera, default_board)
    assert perfect.seconds == pytest.approx(move_s + at_once_s + a.reaction_s, abs=1e-9)
    axes = _attempt("axes", start, target, paper_camera, default_board)
    imagined_s = a.reaction_s + a.glance_s + one / a.rotation_deg_per_s
    assert axes.seconds == pytest.approx(move_s + at_once_s + imagined_s, abs=1e-9)
    assert axes.end.angle_to_deg(target) < 1e-4 and axes.end.distance_to(target) < 1e-9


def test_no_help_beats_perfect_knowledge(paper_camera: Camera, default_board: Board) -> None:
    targets = targets_of(7, paper_camera, default_board)
    for start, target in pairwise(targets):
        times = {
            help_: _attempt(help_, start, target, paper_camera, default_board).seconds
            for help_ in HELPS
        }
        assert min(times.values()) == times["perfect"], times


def test_motions_are_never_faster_than_the_hand(default_board: Board) -> None:
    quick = replace(Assumptions(), fitts_a_s=0.0, fitts_b_s=0.0)
    motion = Motion(np.array([0.25, 0.0, 0.0]), np.array([0.0, 45.0, 0.0]))
    assert motion_s(quick, default_board, motion) == pytest.approx(2 * 1.875)
    nothing = Motion(np.zeros(3), np.zeros(3))
    assert motion_s(Assumptions(), default_board, nothing) == 0


def test_mirrored_tilt_covers_the_same_pixels_from_afar(
    default_board: Board, rng: np.random.Generator
) -> None:
    for _ in range(20):
        pose = Pose.from_vector([*rng.uniform(-50, 50, 3), *rng.uniform(-0.2, 0.2, 2), 0.6])
        other = mirrored_tilt(pose)
        sight = pose.t / np.linalg.norm(pose.t)
        flat = np.eye(3) - np.outer(sight, sight)  # parallel projection along the line of sight
        one, two = (p.apply(default_board.outline) @ flat for p in (pose, other))
        assert np.allclose(one, two, atol=1e-12)
        assert mirrored_tilt(other).angle_to_deg(pose) < 1e-5
        assert pose.R[:, 2] @ sight == pytest.approx(other.R[:, 2] @ sight)


@pytest.mark.slow
def test_table3_repeats_and_says_that_it_is_simulated() -> None:
    trials = table3_trials(1, people=2, sensitivity=False)
    rows = [row for trial in trials for row in run_table3(trial)]
    assert rows[: 9 * len(HELPS)] == run_table3(trials[0])
    other = run_table3(replace(trials[0], seed=2))
    assert [r["seconds"] for r in other] != [r["seconds"] for r in rows[: len(other)]]
    assert len(rows) == 2 * len(HELPS) * 9
    assert {row["kind"] for row in rows} == {"simulated"}
    assert all(row["reached"] for row in rows)
    text = table3_text(rows)
    assert "SIMULATED" in text and "8:17" in text and "24.2 %" in text
    total = {help_: sum(float(r["seconds"]) for r in rows if r["help"] == help_) for help_ in HELPS}
    assert reduction(rows) == pytest.approx(1 - total["steps"] / total["axes"])
    assert min(total, key=lambda help_: total[help_]) == "perfect"


def test_everybody_meets_the_same_poses(paper_camera: Camera, default_board: Board) -> None:
    limits = Limits.for_board(default_board, paper_camera)
    targets = targets_of(0, paper_camera, default_board)
    vectors = np.array([target.vector() for target in targets])
    assert len(targets) == 10 and limits.accepts(paper_camera, default_board, vectors).all()
    assert np.array_equal(vectors, [t.vector() for t in targets_of(0, paper_camera, default_board)])


def test_worse_reading_of_the_axes_takes_longer(paper_camera: Camera, default_board: Board) -> None:
    """The direction of the decisive assumption; its size is the study's result."""
    targets = targets_of(0, paper_camera, default_board)
    times: list[float] = []
    for chance in (0.0, 0.5):
        person, rng = replace(Assumptions(), axes_flip=chance), np.random.default_rng(1)
        times.append(
            sum(
                reach(start, target, "axes", person, paper_camera, default_board, rng).seconds
                for start, target in pairwise(targets)
            )
        )
    assert times[1] > 1.3 * times[0]


def test_paper_table_3_says_21_percent_not_24() -> None:
    """8:17 + 7:24 + 6:52 + 6:59 + 5:41 against 7:19 + 7:28 + 3:42 + 4:07 + 5:08."""
    assert sum(PAPER_S["axes"]) == 35 * 60 + 13 and sum(PAPER_S["steps"]) == 27 * 60 + 44
    assert 1 - sum(PAPER_S["steps"]) / sum(PAPER_S["axes"]) == pytest.approx(0.2125, abs=1e-4)


# -- mistakes -------------------------------------------------------------------------------------


def _sentence(capfd: pytest.CaptureFixture[str], *arguments: object) -> str:
    capfd.readouterr()
    assert main(["study", *map(str, arguments)]) == 2
    told = [line for line in capfd.readouterr().err.splitlines() if line.startswith("venus3d: ")]
    assert len(told) == 1 and told[0].endswith(".")
    return told[0].removeprefix("venus3d: ")


def test_mistakes_are_one_sentence(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    out = ("--output", tmp_path / "out")
    assert _sentence(capfd, "table1", *out).startswith("Name a recording")
    assert "no file or folder nowhere" in _sentence(capfd, "table1", "nowhere", *out)
    assert "no file or folder nowhere" in _sentence(capfd, "table2", "nowhere", *out)
    assert _sentence(capfd, "table2", "nowhere", "--frames", 0, *out).startswith("--frames must")
    assert _sentence(capfd, "table1", "x", "--repeats", 0, *out).startswith("--repeats must")
    assert _sentence(capfd, "table3", "--people", 0, *out).startswith("--people must")
    flip = _sentence(capfd, "table3", "--assume.axes-flip", 2, *out)
    assert flip == "--assume.axes-flip must be from 0 to 1."
    file = tmp_path / "file"
    file.write_text("")
    assert "choose another folder" in _sentence(capfd, "table3", "--output", file)


def test_recordings_of_no_use_are_said(
    capfd: pytest.CaptureFixture[str], tmp_path: Path, default_board: Board
) -> None:
    folder, out = tmp_path / "shots", ("--output", tmp_path / "out")
    folder.mkdir()
    cv2.imwrite(str(folder / "blank.png"), np.full((720, 1280), 128, np.uint8))
    for what in ("table1", "table2"):
        assert "seen in none of the 1 frames" in _sentence(capfd, what, folder, *out)
    picture = np.full((720, 1280), 200, np.uint8)
    texture = default_board.texture(80)
    picture[50 : 50 + texture.shape[0], 60 : 60 + texture.shape[1]] = texture
    for number in range(3):
        cv2.imwrite(str(folder / f"{number}.png"), picture)
    assert "holds only 1 sharp and different view" in _sentence(capfd, "table1", folder, *out)


@pytest.mark.slow
def test_commands_write_rows_and_table(
    capfd: pytest.CaptureFixture[str], tmp_path: Path, shared_data: Path
) -> None:
    stills = shared_data / "lifecam-charuco-8x8"
    runs = {
        "table2": (stills, *STILLS_OPTIONS, "--frames", 3),
        "table3": ("--people", 1, "--quick", "--jobs", 1),
    }
    for what, arguments in runs.items():
        folder = tmp_path / what
        assert main(["study", what, *map(str, arguments), "--output", str(folder)]) == 0
        printed = capfd.readouterr().out
        assert (folder / "table.md").read_text().startswith(printed.rstrip())
        assert len((folder / "rows.csv").read_text().splitlines()) > 5
