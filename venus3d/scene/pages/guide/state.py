"""The view options of a guided calibration, shared by all tabs of a viewer."""

from __future__ import annotations

from dataclasses import dataclass, replace

from venus3d.engine.guidance.prompts import Wording
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide.intents import (
    ChooseAlternative,
    DragBoard,
    Intent,
    NudgeBoard,
    PageAction,
    Straighten,
    Toggle,
    TurnStep,
)
from venus3d.sources.camera_settings import CameraSetting

SECONDS_PER_STEP = 1.2
"""Duration of one step in the animation."""


@dataclass(frozen=True)
class ViewState:
    """View options. Frozen: every change is a new state, so that threads may share it."""

    step: int = 1
    """1 ... 4: the step shown."""
    follow: bool = True
    """Whether the step shown follows the board."""
    strip: bool = False
    """Whether all four steps are shown side by side."""
    all_steps: bool = False
    """Whether the ends of the other steps are drawn too."""
    surroundings: bool = True
    """Whether the floor and the figure who holds the board are drawn."""
    playing: bool = False
    sweep: float = 1.0
    """0 ... 1: the animation's progress in the step shown."""
    dark: bool = True
    paused: bool = False
    autopilot: bool = True
    target: int = 0
    """Number of the step's target."""
    no_pictures: str = ""
    """What is said while no pictures come, or none that can be used; empty while they do."""
    flow: str = ""
    """How pictures flow; empty if nobody has asked."""
    other_size: bool = False
    """Whether they come in another size than the session's."""
    camera_words: bool = False
    """Whether the page speaks of the camera's left and right, not of the holder's."""
    built: bool = False
    """Whether it is shown how the pose is built from the upright board."""
    asked_to_end: bool = False
    """Whether the page asks if the calibration shall end now."""
    straight: bool = False
    """Whether the live picture is shown without lens distortion, once the lens is known."""
    compared: float = 0.5
    """0 ... 1: how much of it, from the left, once the calibration is over; before, all of it."""
    explain: bool = False
    """Whether the loop of the method is shown above the page."""
    camera: tuple[CameraSetting, ...] = ()
    """The settings of a camera at this machine."""
    measure_url: str = ""
    """Address of the page on which one measures with the camera; empty if there is none."""
    over: bool = False
    """Whether no more views are asked for."""

    @property
    def wording(self) -> Wording:
        """Whose left and right are meant, on the whole page."""
        return "camera" if self.camera_words else "holder"

    def seeing(self, snapshot: Snapshot) -> ViewState:
        """The state for this snapshot: a new target follows the board again."""
        state = self
        number = 0 if snapshot.target is None else snapshot.target.number
        if number != self.target:
            state = replace(state, target=number, step=1, follow=True, playing=False, sweep=1.0)
        if state.follow and not state.playing and snapshot.remaining is not None:
            state = replace(state, step=snapshot.remaining.active)
        over = snapshot.phase in ("converged", "finished")
        # Once all is over there is nothing to end, or, if it has converged, only when asked again.
        if state.asked_to_end and (snapshot.phase == "finished" or (over and not state.over)):
            state = replace(state, asked_to_end=False)
        if over != state.over:
            state = replace(state, over=over, straight=over)  # what the calibration is for
        return state

    @property
    def straight_share(self) -> float:
        """0 ... 1: the share of the live picture, from the left, without lens distortion."""
        return 0.0 if not self.straight else self.compared if self.over else 1.0

    def turned_to(self, step: int) -> ViewState:
        """The state with a step picked by hand, until the next target."""
        picked = min(max(step, 1), 4)
        return replace(self, step=picked, follow=False, playing=False, sweep=1.0)

    def following(self, on: bool) -> ViewState:
        """The state in which the step follows the board again, or stays."""
        return replace(self, follow=on, playing=False, sweep=1.0)

    def play(self, on: bool) -> ViewState:
        """The state in which the animation starts at step 1, or stops."""
        if on:
            return replace(self, playing=True, step=1, sweep=0.0)
        return replace(self, playing=False, sweep=1.0)

    def after(self, intent: Intent) -> ViewState:
        """The state after this intent."""
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
                # From step 1 of another pose.
                return replace(self.following(True), asked_to_end=False)
            case PageAction.FINISH:
                return replace(self, asked_to_end=True)
            case PageAction.END_NOW | PageAction.GO_ON | PageAction.NEW_SESSION:
                return replace(self, asked_to_end=False)
            case PageAction.CAPTURE | PageAction.SKIP_TARGET | PageAction.UNDO_VIEW:
                # Whoever goes on calibrating has answered.
                return replace(self, asked_to_end=False)
            case Straighten(share):
                return replace(self, straight=True, compared=share)
            case DragBoard() | NudgeBoard() if self.autopilot:
                return replace(self, autopilot=False)
            case _:
                return self

    def later(self, seconds: float) -> ViewState:
        """The state `seconds` later; the animation repeats."""
        if not self.playing:
            return self
        sweep = self.sweep + seconds / SECONDS_PER_STEP
        if sweep < 1.0:
            return replace(self, sweep=sweep)
        return replace(self, step=self.step % 4 + 1, sweep=0.0)
