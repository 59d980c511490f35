"""The second monitor's message at one moment, and what has just been achieved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from venus3d.engine.guidance.remaining import RemainingSteps
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.languages import translated
from venus3d.render import texts as render_texts
from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.dial import share_left
from venus3d.scene.web.diagnoses import another_board, doubt

Kind = Literal["wait", "warning", "silent", "unseen", "step", "good"]
"""Nothing to do; something is wrong; the picture is old; something is missing; a step to do;
something is done."""
Cue = Literal["reached", "captured", "alarm"]
"""What tones tell: a step is right; a view is captured; pictures have stopped for long."""


@dataclass(frozen=True)
class AudienceViewModel:
    """One moment as a badge, a title and one sentence."""

    kind: Kind
    badge: str
    title: str
    sentence: str
    step: int = 0
    """1 ... 4: the active step, or the one just done; 0 for none."""
    remaining: RemainingSteps | None = None
    """What is left to do, where it matters."""
    left: float = 1.0
    """0 ... 1: what is left of the step, as on the dial."""


def view_model_of(
    snapshot: Snapshot | None, paused: bool = False, silent_since: str = ""
) -> AudienceViewModel:
    """The message for this moment, in which pictures may be paused, or have not come for a time."""
    if silent_since:
        badge, title, sentence = texts.NO_PICTURES
        return AudienceViewModel("silent", badge, title, sentence.format(since=silent_since))
    if paused:
        return AudienceViewModel("wait", *texts.PAUSED)
    if snapshot is None:
        return AudienceViewModel("wait", *texts.STARTING)
    if snapshot.phase == "captured":
        return AudienceViewModel("wait", *texts.THINKING)
    if snapshot.phase == "converged":
        if doubt(snapshot) is not None:
            return AudienceViewModel("warning", *texts.DOUBTED)
        return AudienceViewModel("good", *texts.CONVERGED)
    if snapshot.phase == "finished":
        settled = snapshot.convergence is not None and snapshot.convergence.converged
        if settled and doubt(snapshot) is None:
            return AudienceViewModel("good", *texts.FINISHED)
        return AudienceViewModel("wait", *texts.ENDED)
    todo = snapshot.remaining
    if todo is None or todo.match is None:
        return _unseen(snapshot)
    if todo.is_over and snapshot.taken_back:
        return AudienceViewModel("wait", *texts.TAKEN_BACK, remaining=todo)
    if snapshot.refusal is not None:
        sentence = translated(snapshot.refusal)
        return AudienceViewModel("warning", *texts.REFUSED, sentence, remaining=todo)
    if todo.is_over:
        return AudienceViewModel("good", *texts.HOLD_STILL, remaining=todo)
    step, sentence = todo.active, translated(todo.step(todo.active).prompt.holder)
    left, title = share_left(todo.match, step), render_texts.STEP_SHORT_TITLES[step - 1]
    return AudienceViewModel("step", str(step), title, sentence, step, todo, left)


def _unseen(snapshot: Snapshot) -> AudienceViewModel:
    other = another_board(snapshot)
    if other is not None:
        return AudienceViewModel("warning", *texts.OTHER_BOARD, translated(other.cure))
    sentence = translated(snapshot.instruction.holder)
    if snapshot.phase == "startup" and snapshot.target is None:
        return AudienceViewModel("unseen", *texts.SHOW_BOARD, sentence)
    if snapshot.pose is None:
        return AudienceViewModel("unseen", *texts.NOT_SEEN, sentence, remaining=snapshot.remaining)
    return AudienceViewModel("unseen", *texts.NO_TARGET, sentence)


def achieved(before: Snapshot | None, now: Snapshot) -> tuple[Cue, AudienceViewModel] | None:
    """What became right between two snapshots, and its message."""
    if before is None:
        return None
    if now.captured_count > before.captured_count:
        return "captured", AudienceViewModel("good", *texts.CAPTURED)
    was = before.remaining
    same = before.target is not None and before.target is now.target
    if was is None or now.remaining is None or not same:
        return None
    step = was.active
    if was.step(step).done or not now.remaining.step(step).done:
        return None
    title = render_texts.STEP_SHORT_TITLES[step - 1]
    sentence = texts.STEP_DONE.format(title=title)
    return "reached", AudienceViewModel("good", "✓", title, sentence, step, now.remaining)
