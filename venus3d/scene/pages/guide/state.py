"""What is shown, apart from the calibration itself: one state for all tabs of a viewer."""

from __future__ import annotations

from dataclasses import dataclass, replace

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide.intents import (
    ChooseAlternative,
    DragBoard,
    Intent,
    Toggle,
    TurnStep,
)

SECONDS_PER_STEP = 1.2
"""How long the animation spends on one step."""


@dataclass(frozen=True)
class ViewState:
    """View options. Frozen: every change is a new state, so that threads may share it."""

    step: int = 1
    """1 ... 4: the step that is shown."""
    follow: bool = True
    """Whether the step shown follows the step that the board is on."""
    strip: bool = False
    """Whether all four steps are spread out side by side."""
    playing: bool = False
    sweep: float = 1.0
    """0 ... 1: how far the step shown has been carried out in the animation."""
    dark: bool = True
    paused: bool = False
    autopilot: bool = True
    target: int = 0
    """Number of the target that the step belongs to."""

    def seeing(self, snapshot: Snapshot) -> ViewState:
        """The state once this snapshot is shown: a new target starts to follow again."""
        state = self
        number = 0 if snapshot.target is None else snapshot.target.number
        if number != self.target:
            state = replace(state, target=number, step=1, follow=True, playing=False, sweep=1.0)
        if state.follow and not state.playing and snapshot.match is not None:
            state = replace(state, step=snapshot.match.active_step)
        return state

    def turned_to(self, step: int) -> ViewState:
        """Another step is picked by hand; it stays until the next target."""
        picked = min(max(step, 1), 4)
        return replace(self, step=picked, follow=False, playing=False, sweep=1.0)

    def following(self, on: bool) -> ViewState:
        """The step shown follows the board again, or stays."""
        return replace(self, follow=on, playing=False, sweep=1.0)

    def play(self, on: bool) -> ViewState:
        """The animation starts at step 1, or stops where it is."""
        if on:
            return replace(self, playing=True, step=1, sweep=0.0)
        return replace(self, playing=False, sweep=1.0)

    def after(self, intent: Intent) -> ViewState:
        """What is shown once that was asked for."""
        match intent:
            case TurnStep(by):
                return self.turned_to(self.step + by)
            case Toggle("playing"):
                return self.play(not self.playing)
            case Toggle("follow"):
                return self.following(not self.follow)
            case Toggle(option):
                return replace(self, **{option: not getattr(self, option)})
            case ChooseAlternative():
                return self.following(True)  # from step 1 of another pose
            case DragBoard() if self.autopilot:
                return replace(self, autopilot=False)
            case _:
                return self

    def later(self, seconds: float) -> ViewState:
        """The animation, `seconds` later; it goes round and round."""
        if not self.playing:
            return self
        sweep = self.sweep + seconds / SECONDS_PER_STEP
        if sweep < 1.0:
            return replace(self, sweep=sweep)
        return replace(self, step=self.step % 4 + 1, sweep=0.0)
