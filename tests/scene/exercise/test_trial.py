"""The trial: who gets which help, how times are taken, and a whole rehearsal with real parts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from venus3d.cli import main
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.planning.limits import Limits
from venus3d.scene.pages.exercise.options import TrialOptions
from venus3d.scene.pages.exercise.run import run_trial
from venus3d.scene.pages.exercise.trial import Trial
from venus3d.scene.pages.exercise.trial_plan import Plan, order_of, plan_of, targets_of, times_of
from venus3d.scene.pages.exercise.view_model import TRIAL_HELPS, Press
from venus3d.storage.exercise import ExerciseFile, ExerciseRow

FAR = Pose.from_vector([0, 0, 0, 0.1, 0.05, 0.9])
TARGETS = tuple(
    Pose.from_vector(p)
    for p in ([20, 0, 0, 0, 0, 0.5], [0, 30, 0, 0, 0, 0.5], [0, 0, 40, 0, 0, 0.6])
)


# -- who gets which help -----------------------------------------------------------------------


def test_three_participants_are_a_latin_square_and_six_are_balanced() -> None:
    orders = [order_of(number) for number in range(1, 7)]
    assert len(set(orders)) == 6
    for place in range(3):
        assert {order[place] for order in orders[:3]} == set(TRIAL_HELPS)
        assert set(Counter(order[place] for order in orders).values()) == {2}
    followed = Counter(pair for order in orders for pair in pairwise(order))
    assert len(followed) == 6 and set(followed.values()) == {2}
    assert order_of(7) == order_of(1)


def row(plan: Plan, help_: str, pose: int, attempt: int = 1) -> ExerciseRow:
    return ExerciseRow(
        participant=plan.participant,
        number=plan.number,
        order=" ".join(plan.order),
        attempt=attempt,
        place=1,
        help=help_,
        pose=pose,
        outcome="reached",
        seconds=1.0,
        since_first_s=1.0,
        since_start_s=1.0,
        overlap=0.9,
        off_mm=1.0,
        off_deg=1.0,
        xr_deg=0.0,
        yr_deg=0.0,
        zr_deg=0.0,
        xt_mm=0.0,
        yt_mm=0.0,
        zt_mm=500.0,
        source="sim",
        moved_by="person",
        seed=0,
        poses=3,
        time="",
    )


def test_participants_are_numbered_as_they_come() -> None:
    first = plan_of(None, [])
    assert (first.participant, first.number, first.order) == ("P1", 1, order_of(1))
    rows = [row(first, "steps", 1)]
    second = plan_of("Anna", rows)
    assert (second.number, second.order) == (2, order_of(2))
    rows.append(row(second, "axes", 1))
    assert plan_of(None, rows).participant == "P3"


def test_who_was_interrupted_goes_on_and_who_is_done_is_refused() -> None:
    plan = plan_of("Anna", [])
    rows = [row(plan, plan.order[0], pose) for pose in (1, 2, 3)]
    rows += [row(plan, plan.order[1], pose) for pose in (1, 2)]
    again = plan_of("Anna", rows)
    assert (again.number, again.order) == (plan.number, plan.order)
    assert again.done == {plan.order[0]}
    assert again.attempt(plan.order[1]) == 2 and again.attempt(plan.order[2]) == 1
    rows += [row(plan, help_, 3, attempt=2) for help_ in plan.order[1:]]
    with pytest.raises(VenusError, match=r"Anna has done this trial already.*--participant"):
        plan_of("Anna", rows)


def test_targets_are_within_the_limits_and_repeat(
    paper_camera: Camera, default_board: Board
) -> None:
    limits = Limits.for_board(default_board, paper_camera)
    one, same, other = (
        targets_of(seed, paper_camera, default_board, limits, 10) for seed in (1, 1, 2)
    )
    vectors = np.array([pose.vector() for pose in one])
    assert limits.accepts(paper_camera, default_board, vectors).all()
    np.testing.assert_array_equal(vectors, [pose.vector() for pose in same])
    assert not np.allclose(vectors, [pose.vector() for pose in other])


# -- how times are taken -----------------------------------------------------------------------


class Hand:
    """A hand that jumps, in front of the paper's camera without noise."""

    def __init__(self, camera: Camera, board: Board, plan: Plan) -> None:
        self.rows: list[ExerciseRow] = []
        self.time_s = 100.0
        self._camera, self._board = camera, board
        self.trial = Trial(
            board, camera, plan, TARGETS, self.rows.append, settings=Settings(hold_frames=3)
        )

    def hold(self, pose: Pose, frames: int, *, by_machine: bool = False) -> None:
        """Hold the board there for some frames, a tenth of a second each."""
        for _ in range(frames):
            pixels = self._camera.project(pose.apply(self._board.corners))
            seen = Observation(
                np.arange(len(pixels)), pixels, self._camera.image_size, time_s=self.time_s
            )
            self.trial.observe(seen, by_machine=by_machine)
            self.time_s += 0.1


@pytest.fixture
def hand(paper_camera: Camera, default_board: Board) -> Iterator[Hand]:
    yield Hand(paper_camera, default_board, plan_of("Anna", []))


def test_the_clock_counts_what_the_hand_took(hand: Hand) -> None:
    hand.hold(TARGETS[0], 10)
    assert not hand.rows, "nothing counts before the teacher presses Start"
    hand.trial.begin()
    hand.hold(FAR, 20)  # 2.0 s; then the jump is motion, so the hold begins one frame later
    for target in TARGETS:
        hand.hold(target, 4)
        hand.hold(FAR, 10)
    assert [row.pose for row in hand.rows] == [1, 2, 3]
    assert [row.outcome for row in hand.rows] == ["reached"] * 3
    # Shown at the first frame after Start; done with at the fourth frame at the target.
    assert [row.seconds for row in hand.rows] == pytest.approx([2.3, 1.4, 1.4])
    assert [row.since_first_s for row in hand.rows] == pytest.approx([0.0, 1.4, 2.8])
    assert [row.since_start_s for row in hand.rows] == pytest.approx([2.3, 3.7, 5.1])
    assert all(row.overlap > 0.99 and row.off_mm < 1 and row.off_deg < 0.2 for row in hand.rows)
    view = hand.trial.view()
    assert (view.stage, view.place, view.help) == ("ready", 2, order_of(1)[1])
    assert times_of(view.rows)[0].reached_s == pytest.approx((1.4, 1.4)), (
        "the first pose is for practice"
    )


def test_a_pose_in_passing_does_not_count(hand: Hand) -> None:
    hand.trial.begin()
    for _ in range(5):
        hand.hold(FAR, 1)
        hand.hold(TARGETS[0], 3)
    assert not hand.rows
    hand.hold(TARGETS[0], 1)
    assert len(hand.rows) == 1


def test_a_pose_that_is_given_up_is_written_as_such(hand: Hand) -> None:
    assert not hand.trial.give_up()
    hand.trial.begin()
    hand.hold(FAR, 5)
    assert hand.trial.give_up()
    (row,) = hand.rows
    assert (row.outcome, row.pose) == ("given up", 1)
    assert row.off_mm == pytest.approx(1000 * FAR.distance_to(TARGETS[0]), rel=1e-3)
    hand.hold(TARGETS[1], 4)
    assert [row.outcome for row in hand.rows] == ["given up", "reached"]


def test_a_time_to_which_the_simulated_hand_helped_is_marked(hand: Hand) -> None:
    hand.trial.begin()
    hand.hold(FAR, 2, by_machine=True)
    hand.hold(TARGETS[0], 4)
    hand.hold(TARGETS[1], 4)
    assert [row.moved_by for row in hand.rows] == ["autopilot", "person"]


def test_a_hint_on_the_simulated_hand_is_gone_once_it_moves_the_board(hand: Hand) -> None:
    hand.trial.say("drag it", 60)
    assert hand.trial.view().note == "drag it"
    hand.trial.handle(Press("autopilot"))
    assert hand.trial.view().note == ""


def test_helps_come_in_the_participants_order_and_the_trial_ends(hand: Hand) -> None:
    while hand.trial.begin():
        for target in TARGETS:
            hand.hold(target, 4)
    assert hand.trial.stage == "over"
    assert [row.help for row in hand.rows] == [help_ for help_ in order_of(1) for _ in TARGETS]
    assert [row.place for row in hand.rows] == [1, 1, 1, 2, 2, 2, 3, 3, 3]
    assert not hand.trial.begin() and not hand.trial.give_up()


# -- the whole, and mistakes ---------------------------------------------------------------------


@pytest.mark.slow
def test_two_rehearsals_share_a_file_and_differ_in_order(tmp_path: Path) -> None:
    options = TrialOptions(
        headless=True, poses=2, camera_size="640x360", speed=2.0, output=tmp_path
    )
    for number in (1, 2):
        result = run_trial(options)
        assert result.complete and result.plan.participant == f"P{number}"
    file = ExerciseFile(tmp_path / "trial.csv", "trial")
    file.close()
    for number in (1, 2):
        mine = [row for row in file.rows if row.number == number]
        assert [row.help for row in mine] == [help_ for help_ in order_of(number) for _ in range(2)]
        assert [row.pose for row in mine] == [1, 2] * 3
        assert all(row.moved_by == "autopilot" and row.outcome == "reached" for row in mine)
        assert all(row.overlap > 0.85 and row.seconds > 0 for row in mine)
    targets = {(row.pose, row.xr_deg, row.yr_deg, row.zt_mm) for row in file.rows}
    assert len(targets) == 2, "the same two targets for everybody and every help"


MISTAKES: dict[str, tuple[tuple[str, ...], str]] = {
    "a real camera that is not calibrated": (
        ("0",),
        "A trial needs a calibrated camera: calibrate it first with venus3d guide, then give its "
        "file with --camera camera.yaml.",
    ),
    "no such camera file": (
        ("sim", "--headless", "--camera", "none.yaml"),
        "The camera file none.yaml cannot be read (no such file or directory); give another.",
    ),
    "no name": (
        ("sim", "--participant", " "),
        "The participant's name is empty; leave --participant out for P1, P2.",
    ),
    "nobody to rehearse": (
        ("0", "--headless", "--camera", "camera.yaml"),
        "A trial without a page is a rehearsal of the simulated hand, so --headless goes with sim "
        "only.",
    ),
    "one pose": (
        ("sim", "--poses", "1"),
        "--poses must be from 2 to 100, not 1.",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_one_sentence(
    mistake: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    arguments, sentence = MISTAKES[mistake]
    assert main(["trial", *arguments, "--output", str(tmp_path)]) == 2
    assert capsys.readouterr().err == f"venus3d: {sentence}\n"


def test_times_are_never_written_into_another_file(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "trial.csv"
    path.write_text("my,own,table\n")
    assert main(["trial", "sim", "--headless", "--output", str(tmp_path)]) == 2
    assert capsys.readouterr().err == (
        f"venus3d: {path} is no file of trial times, or of another version; move it away or "
        "choose another folder with --output.\n"
    )
    assert path.read_text() == "my,own,table\n"


def test_a_folder_that_cannot_be_written(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "taken").write_text("")
    place = tmp_path / "taken" / "folder"
    assert main(["trial", "sim", "--headless", "--output", str(place)]) == 2
    said = capsys.readouterr().err
    assert "cannot be written" in said and "--output" in said and said.count("\n") == 1


def test_guide_says_where_the_trial_went(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["guide", "0", "--trial", "--participant", "Anna"]) == 2
    assert capsys.readouterr().err == (
        "venus3d: The trial is a command of its own: venus3d trial [SOURCE]; --trial-poses is its "
        "--poses.\n"
    )
