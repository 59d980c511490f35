"""Options of a guided calibration; a docstring is its option's `--help`."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from venus3d.engine.errors import VenusError
from venus3d.engine.guidance.prompts import Wording
from venus3d.engine.planning.settings import Cost, Method, PlanningSettings, Strategy
from venus3d.options import (
    BoardOptions,
    LanguageOption,
    LensName,
    LimitOptions,
    Switch,
    check_range,
    image_size_of,
    optional,
)
from venus3d.scene.web.monitor import audience_address
from venus3d.sources.camera_settings import CameraSettings
from venus3d.sources.sim_cameras import SIMULATED, SimCamera
from venus3d.sources.view_errors import ViewErrors


@dataclass(frozen=True)
class SimOptions:
    """The simulated camera (source sim)."""

    camera: SimCamera = "webcam"
    """The paper's webcam, an action camera (120° across), a fisheye (190°) or a telephoto (12°)."""
    bow_mm: float = 0.0
    """How far the board's middle lies behind its left and right ends."""
    view_bow_mm: float = 0.0
    """Spread of a bow of the board that is drawn anew for each pose, as hands flex it."""
    view_bias_px: float = 0.0
    """Spread of a smooth shift of the corners over the board, anew for each pose, as light does."""
    view_blur_px: float = 0.0
    """Spread of a blur that comes on top of the camera's, anew every second, as a focus hunts."""

    def check(self) -> None:
        """Raises `VenusError` for the first option out of its range."""
        check_range("--sim.bow-mm", self.bow_mm, -20, 20)
        check_range("--sim.view-bow-mm", self.view_bow_mm, 0, 10)
        check_range("--sim.view-bias-px", self.view_bias_px, 0, 5)
        check_range("--sim.view-blur-px", self.view_blur_px, 0, 10)

    @property
    def view_errors(self) -> ViewErrors:
        """What the views' corners share."""
        return ViewErrors(self.view_bow_mm / 1000, self.view_bias_px, self.view_blur_px)


@dataclass(frozen=True)
class GuideOptions:
    """Calibrate a camera with guidance, pose by pose, in the browser."""

    source: Annotated[Positional[str], arg(metavar="SOURCE")] = SIMULATED
    """sim, a camera's number or device, a stream's address, a video, a folder or a pattern of
    pictures, watch:DIR, a ROS bag (BAG or BAG:/topic)."""
    board: BoardOptions = field(default_factory=BoardOptions)
    camera_size: Annotated[str | None, optional("WIDTHxHEIGHT", "as it comes")] = None
    """Size of the picture to ask a camera for, or to simulate (sim: 1280x720)."""
    camera: CameraSettings = field(default_factory=CameraSettings)
    flip: Switch = False
    """Exchange left and right: for pictures that come mirrored. The camera file holds for these."""
    method: Method = "global"
    """How the next pose is found: ours (global), the paper's (venus), Rojtberg's, or by chance."""
    cost: Annotated[Cost | None, arg(help_behavior_hint="(the method's own)")] = None
    """What the search minimises: by default projection-variance for global, sum-iod for venus."""
    search: Annotated[Strategy | None, arg(help_behavior_hint="(the method's own)")] = None
    """How it searches: by default annealing for venus, the whole space for global."""
    wanted_error: Annotated[float, arg(metavar="PX")] = 0.3
    """Projection uncertainty in pixels that is enough; the views until then are forecast."""
    limits: LimitOptions = field(default_factory=LimitOptions)
    keep_best: Switch = False
    """Method venus: take the best pose of its search, not the last one."""
    overlap: float = 0.85
    """How much the board must cover its target in the picture, 0 to 1, to be captured."""
    auto_capture: bool = True
    """Capture by itself once the board is in place and still; otherwise only on command."""
    convergence: Literal["repaired", "printed"] = "repaired"
    """When a parameter counts as settled: the repaired rule, or the paper's as printed."""
    max_views: int = 20
    """End after this many views at the latest."""
    lens: LensName = "auto"
    """The lens model; auto begins with five coefficients and takes a fisheye's or eight when the
    views say so."""
    seed: int = 0
    """One number that makes a run repeat: search, simulated noise, autopilot."""
    autopilot: bool = False
    """Let a simulated hand walk the board through the four steps (sim only)."""
    speed: float = 1.0
    """How fast the simulated hand moves; 1 is a calm person (sim only)."""
    sim: SimOptions = field(default_factory=SimOptions)
    wording: Wording = "holder"
    """Whose left and right the page means: the holder's, or the camera's (X changes it)."""
    language: LanguageOption = None
    """Language of the pages, the second one too; usually that of the first browser."""
    explain: Switch = False
    """Show the method's loop with its figures above the page, for teaching (9 changes it)."""
    headless: Switch = False
    """No viewer: run to convergence, to --max-views or to the recording's end, then print; the exit
    code is 3 if it breaks off before."""
    stats: Switch = False
    """Show on the page, and print every ten seconds, how many pictures a second come, are searched
    and sent, how old they are when sent, and how many are left out."""
    host: str = "127.0.0.1"
    """Address the viewer listens on; with 0.0.0.0 the address that is printed opens the page on
    other machines too, by the token in it."""
    port: int = 8080
    """Port of the viewer; the next free one is used if it is taken."""
    tour: bool = True
    """Show a browser that is new here around, once."""
    audience: Annotated[str | None, optional("[HOST:]PORT")] = None
    """A second, read-only page for a monitor or a class; with 0.0.0.0:PORT for other machines."""
    audience_token: Switch = False
    """Other machines see the second page only by the token in the address that is printed."""
    audience_view: Literal["picture", "lens"] = "picture"
    """The second page shows the picture with outlines, or the 3D steps through the lens."""
    audience_mirror: bool = True
    """The second page's picture as in a mirror, for whoever faces the camera."""
    audience_light: Switch = False
    """The second page in light colours, for a bright room."""
    audience_sound: Literal["off", "tones", "voice", "both"] = "off"
    """The second page's sounds: tones that quicken near the target, sentences spoken, or both."""
    output: Annotated[Path | None, optional("DIR")] = None
    """Folder of the session: every view's picture, a journal, camera.yaml and result.json; one with
    the date in venus3d-sessions if none is named."""
    record: bool = True
    """Keep the session in its folder, so that it can be gone on with."""
    resume: Annotated[Path | None, optional("DIR")] = None
    """Go on with the session in this folder: its views, its source, board and other options, unless
    they are given anew."""
    known_camera: Annotated[
        Path | None, arg(name="from", metavar="FILE", help_behavior_hint="(optional)")
    ] = None
    """Start from a camera that is known: any file that import reads. A result.json goes on from its
    views; with another file the result is that of the new views alone."""
    json: Switch = False
    """Print the result as one JSON object on the last line."""

    def check(self) -> None:
        """Raises `VenusError` for the first option that cannot be met."""
        self.board.board()
        self.camera.check()
        self._check_audience()
        PlanningSettings(self.method, self.cost, self.search)
        self.limits.check()
        check_range("--wanted-error", self.wanted_error, 0.001, 100)
        check_range("--overlap", self.overlap, 0.1, 0.99)
        check_range("--speed", self.speed, 0.1, 10)
        self.sim.check()
        self._check_simulated()
        check_range("--max-views", self.max_views, 2, 1000)
        check_range("--seed", self.seed, 0, 2**63)
        if self.camera_size is not None:
            image_size_of(self.camera_size)

    def _check_simulated(self) -> None:
        chosen = self.autopilot or self.speed != 1 or self.sim != SimOptions()
        if self.source != SIMULATED and chosen:
            raise VenusError(
                "--autopilot, --speed and --sim are for the simulated camera; leave them out, or "
                "guide sim."
            )

    def _check_audience(self) -> None:
        if self.audience is None:
            chosen = (
                not self.audience_mirror,
                self.audience_light,
                self.audience_sound != "off",
                self.audience_token,
            )
            if self.audience_view != "picture" or any(chosen):
                raise VenusError("This choice is about the second page; open it with --audience.")
            return
        if self.headless:
            raise VenusError("--audience shows what a viewer shows; leave --headless out.")
        audience_address(self.audience, self.port)

    @property
    def image_size(self) -> tuple[int, int] | None:
        """`camera_size` as (width, height); None if it was not given."""
        return None if self.camera_size is None else image_size_of(self.camera_size)
