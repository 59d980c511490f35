"""When the second monitor speaks: of what is new, to who hesitates, and never too often."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.sound import GAP_S, HESITATION_S, Speaker, spoken
from venus3d.scene.pages.audience.view_model import AudienceViewModel

MOVE = AudienceViewModel("step", "1", "Move", "Move the board 60 mm up.", 1, left=0.9)
TURN = AudienceViewModel("step", "3", "Swing", "Swing the edge by 31°.", 3, left=0.8)
HOLD = AudienceViewModel("good", *texts.HOLD_STILL)
GONE = AudienceViewModel("unseen", *texts.NOT_SEEN, "The board is not seen.")
DONE = AudienceViewModel("good", "✓", "Move", texts.STEP_DONE.format(title="Move"), 1)


def spoken_times(speaker: Speaker, moments: list[tuple[float, AudienceViewModel]]) -> list[float]:
    return [at for at, moment in moments if speaker.due(moment, at)]


def test_never_more_often_than_once_in_four_seconds() -> None:
    """Whatever comes, every 50 ms, for ten minutes of a person who does everything at once."""
    rng = np.random.default_rng(4)
    kinds = (MOVE, TURN, HOLD, GONE, DONE)
    moment, moments = MOVE, []
    for at in np.arange(0, 600, 0.05):
        if rng.random() < 0.1:
            moment = replace(kinds[rng.integers(len(kinds))], left=float(rng.random()))
        moments.append((float(at), moment))
    times = spoken_times(Speaker(), moments)
    assert len(times) > 60 and GAP_S > 4.0
    assert min(np.diff(times)) >= 4.0


def test_what_is_new_is_spoken_at_once_or_when_it_may_be() -> None:
    speaker = Speaker()
    assert speaker.due(MOVE, 100.0) == "Move the board 60 millimetres up."
    assert speaker.due(MOVE, 101.0) == ""
    assert speaker.due(TURN, 102.0) == "", "too early"
    assert speaker.due(TURN, 100.1 + GAP_S) == "Swing the edge by 31 degrees."
    assert speaker.due(HOLD, 110.0) == texts.HOLD_STILL[2]
    assert speaker.due(HOLD, 200.0) == "", "it was said, and nobody hesitates"


def test_a_step_that_is_done_is_left_to_the_tone_and_the_next_one_is_spoken() -> None:
    speaker = Speaker()
    assert speaker.due(MOVE, 0.0)
    assert not speaker.due(DONE, 5.0)
    assert speaker.due(TURN, 5.9)


@pytest.mark.parametrize("moment", [MOVE, GONE])
def test_who_hesitates_hears_it_again(moment: AudienceViewModel) -> None:
    times = spoken_times(Speaker(), [(at, moment) for at in np.arange(0.0, 30.0, 0.5)])
    assert times == list(np.arange(0.0, 30.0, HESITATION_S))


def test_who_comes_nearer_is_left_alone() -> None:
    """60 s of steady progress: only the first time; a board that trembles is no progress."""
    way = [(float(at), replace(MOVE, left=0.9 - 0.014 * at)) for at in np.arange(0, 60, 0.5)]
    assert spoken_times(Speaker(), way) == [0.0]
    rng = np.random.default_rng(1)
    tremor = [
        (float(at), replace(MOVE, left=0.5 + 0.01 * float(rng.standard_normal())))
        for at in np.arange(0, 60, 0.5)
    ]
    assert len(spoken_times(Speaker(), tremor)) >= 6


def test_units_are_spoken_as_words() -> None:
    assert spoken("Move the board 1 mm up and 20 mm down.").count("millimetres") == 2
    assert "°" not in spoken("Tilt it by 12°.")
