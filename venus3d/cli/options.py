"""Options of single commands (see also `venus3d.options`)."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from venus3d.engine.geometry.pose import Axes
from venus3d.engine.geometry.resize import ResizeBy
from venus3d.options import BoardOptions, LanguageOption, LensName, LimitOptions, Switch, optional

Number = Positional[float]


@dataclass(frozen=True)
class CalibrateOptions:
    """Calibrate from pictures or a video that exist already."""

    source: Annotated[Positional[str], arg(metavar="SOURCE")]
    """A folder of pictures, a pattern such as "shots/*.jpg", a video, or a session's folder."""
    board: BoardOptions = field(default_factory=BoardOptions)
    flip: Switch = False
    """Exchange left and right: for pictures that are mirrored. The camera file holds for these."""
    lens: LensName = "auto"
    """The lens model; auto finds out whether five coefficients do, or it is a fisheye."""
    max_frames: int = 40
    """Maximum number of frames from a video: the most informative ones, no near-duplicates."""
    every: Annotated[int | None, optional("N", "chosen")] = None
    """Take every Nth frame of a video that shows the board, instead of choosing."""
    output: Annotated[Path | None, optional("DIR")] = None
    """Folder for camera.yaml and result.json; an earlier result there is kept."""
    json: Switch = False
    """Print the result as one JSON object on the last line."""


@dataclass(frozen=True)
class ReplayOptions:
    """Show a recorded session in the browser, with a time line, or write it as a film or a page."""

    session: Annotated[Positional[Path], arg(metavar="DIR")]
    """The folder of a session, as venus3d guide keeps it."""
    export: Annotated[Path | None, optional("FILE")] = None
    """Write a file instead. FILE.mp4: a film, each view's picture with its target, under what was
    known then. FILE.html: a page to hand out that works offline, with the scene of every view."""
    language: LanguageOption = None
    """Language of the page."""
    host: str = "127.0.0.1"
    """Address the page listens on."""
    port: int = 8080
    """Port of the page; the next free one is used if it is taken."""


@dataclass(frozen=True)
class DoctorOptions:
    """Look at what this machine has: OpenGL, cameras, port, versions, disk, browser."""

    port: int = 8080
    """The port that shall be free."""


@dataclass(frozen=True)
class DecomposeOptions:
    """Take a pose apart into four steps, in words and pictures."""

    xr: Annotated[Number, arg(metavar="XR")]
    """Turn about X in degrees: positive brings the top edge towards the camera."""
    yr: Annotated[Number, arg(metavar="YR")]
    """Turn about Y in degrees: positive brings the picture's right edge towards the camera."""
    zr: Annotated[Number, arg(metavar="ZR")]
    """Turn about Z in degrees: positive is clockwise in the picture."""
    xt: Annotated[Number, arg(metavar="XT")]
    """The board's centre in millimetres, to the right of the camera's axis."""
    yt: Annotated[Number, arg(metavar="YT")]
    """The board's centre in millimetres, below the camera's axis."""
    zt: Annotated[Number, arg(metavar="ZT")]
    """The board's centre in millimetres, in front of the camera."""
    axes: Axes = "fixed"
    """Turns about the camera's fixed axes, or about the board's own axes as they turn with it."""
    board: BoardOptions = field(default_factory=BoardOptions)
    limits: LimitOptions = field(default_factory=LimitOptions)
    camera: Annotated[Path | None, optional("FILE", "the simulated one")] = None
    """The camera to use: a result.json, a camera.yaml, any other camera file, or the folder of a
    calibration."""
    output: Annotated[Path, arg(metavar="DIR")] = Path("steps")
    """Folder for the pictures step-1.png to step-4.png."""


@dataclass(frozen=True)
class BoardCommand:
    """Write the board to print: PDF, SVG or PNG, at true scale. Or show it on a screen."""

    board: BoardOptions = field(default_factory=BoardOptions)
    paper: Annotated[str | None, optional("PAPER", "a4 for PDF, else fit")] = None
    """a4, a3, letter, a size such as 500x700 (mm), or fit, as large as the board. A board that is
    larger comes on several pages (PDF) with marks to cut by."""
    margin_mm: float = 10.0
    """Free border around a board that is larger than the paper, or with fit, in millimetres."""
    dpi: float = 300.0
    """PNG: dots per inch, adapted a little so that a square is a whole number of dots."""
    plain: Switch = False
    """Only the board: no ruler, words and QR code."""
    show: Switch = False
    """Open a page that shows the board on this screen in true size instead."""
    find: Annotated[str | None, optional("SOURCE")] = None
    """Instead, look at pictures, a video or a camera, and print which board they show with the
    options to copy."""
    save: Annotated[Path | None, optional("FILE")] = None
    """Write only the board's options to a file, which --board FILE reads."""
    output: Annotated[Path, arg(metavar="PATH")] = Path("board.pdf")
    """The file to write, .pdf, .svg or .png; in a folder board.pdf."""


@dataclass(frozen=True)
class CamerasOptions:
    """List the cameras at this machine: sizes and rates, controls, the source to name."""

    output: Annotated[Path | None, optional("DIR")] = None
    """Folder for a picture of each camera."""
    json: Switch = False
    """Print all of it as one JSON object on the last line."""


_FORMATS = (
    "opencv-yaml, opencv-json, opencv-xml, ros, kalibr, colmap, mrcal, nerfstudio, matlab, "
    "blender, unity, json"
)
_FormatOption = Annotated[str | None, optional("FORMAT", "found out from the file")]
_NameOption = Annotated[str | None, optional("NAME", "the only one")]


@dataclass(frozen=True)
class ExportOptions:
    """Write a calibrated camera in the format of another program."""

    source: Annotated[Positional[Path], arg(metavar="SOURCE")]
    """A result.json, a camera.yaml, any other camera file, or a folder that holds one of the first
    two."""
    to: Annotated[
        str | None, arg(metavar="FORMAT", help=_FORMATS, help_behavior_hint="(usual: by --output)")
    ] = None
    output: Annotated[Path | None, optional("FILE", "the format's own name")] = None
    """The file to write."""
    size: Annotated[str | None, optional("WxH", "as calibrated")] = None
    """For pictures of another size, WIDTHxHEIGHT."""
    by: Annotated[ResizeBy | None, arg(help_behavior_hint="(needed for another shape)")] = None
    """How the camera makes them: scaled, cropped, or by binning whole pixels."""
    offset: Annotated[str | None, optional("X,Y", "centred")] = None
    """First pixel of the crop."""
    without_k3: Switch = False
    """For a format without k3: the nearest camera that has none, and how far it is off."""
    undistorted: Switch = False
    """The file is for undistorted pictures: leave the distortion out."""
    format: _FormatOption = None
    """Format of SOURCE."""
    name: _NameOption = None
    """Which camera of SOURCE: cam1 of Kalibr's chain, an id of cameras.txt."""


@dataclass(frozen=True)
class ImportOptions:
    """Read another program's camera file and write it as a camera.yaml."""

    file: Annotated[Positional[Path], arg(metavar="FILE")]
    """A file as `venus3d export` writes it, by that program or by us."""
    output: Annotated[Path, arg(metavar="FILE")] = Path("camera.yaml")
    """The file to write."""
    format: _FormatOption = None
    """Format of FILE."""
    name: _NameOption = None
    """Which camera of FILE: cam1 of Kalibr's chain, an id of cameras.txt."""


@dataclass(frozen=True)
class UndistortOptions:
    """Write pictures or a video without lens distortion, and the camera that they are of then."""

    source: Annotated[Positional[str], arg(metavar="SOURCE")]
    """A picture, a folder of pictures, a pattern such as "shots/*.jpg", or a video."""
    camera: Annotated[Path, arg(metavar="FILE")]
    """A result.json, a camera.yaml, any other camera file, or the folder of a calibration."""
    output: Annotated[Path, arg(metavar="DIR")] = Path("undistorted")
    """Folder for the pictures (PNG) or the video (MP4), and for their camera.yaml."""
    alpha: Annotated[float | None, optional("0..1", "the same camera matrix")] = None
    """0: zoomed so that no pixel is black; 1: so that every pixel of the source is kept."""


@dataclass(frozen=True)
class ReportOptions:
    """Write a calibration's report: one HTML file to read, print and send."""

    source: Annotated[Positional[Path], arg(metavar="SOURCE")]
    """The folder of a session or of a calibration, or its result.json."""
    output: Annotated[Path | None, optional("FILE", "beside it")] = None
    """The file to write."""


@dataclass(frozen=True)
class VerifyOptions:
    """Check with fresh views whether an existing calibration still holds."""

    file: Annotated[Positional[Path], arg(metavar="FILE")]
    """The calibration: a result.json, a camera.yaml, any other camera file, or their folder."""
    source: Annotated[Positional[str], arg(metavar="SOURCE")]
    """Fresh views of the board: a folder of pictures, a pattern, a video; or a camera's number or a
    stream, with the guide's page to take them."""
    board: BoardOptions = field(default_factory=BoardOptions)
    limit: Annotated[float, arg(metavar="PX")] = 1.0
    """Largest mean change over the picture that does no harm, pixels."""
    max_frames: int = 40
    """Maximum number of frames from a video."""
    flip: Switch = False
    """Exchange left and right: for pictures that are mirrored."""
    output: Annotated[Path | None, optional("DIR")] = None
    """Folder for verification.html and verification.json."""
    json: Switch = False
    """Print the verification as one JSON object on the last line."""
    format: _FormatOption = None
    """Format of FILE."""
    name: _NameOption = None
    """Which camera of FILE: cam1 of Kalibr's chain, an id of cameras.txt."""
