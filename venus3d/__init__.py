"""Guided camera calibration: where to hold the board next, why, and in which four steps.

    import venus3d

    board = venus3d.Board(columns=9, rows=6, square=0.028, marker=0.021)
    target = venus3d.Pose.from_vector([25, -30, 20, 0.04, -0.02, 0.52])
    camera = venus3d.Camera.guess((1280, 720))
    for step in venus3d.decompose(target, camera, board):
        print(venus3d.step_prompt(step).holder)

Lengths are in metres, times in seconds; whole pixel coordinates are pixel centres, as in OpenCV. A
pose is `T_camera_board`: it takes points of the board's frame (origin at its centre, +x along the
columns, +y along the rows) to the camera's optical frame (+x right, +y down, +z forward).

Everything below is loaded when it is first used, so that `import venus3d` itself costs nothing.
What is not listed here may change without notice.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from venus3d.engine.calibration.calibration import Calibration
    from venus3d.engine.calibration.checks import diagnose
    from venus3d.engine.calibration.detection import Detector
    from venus3d.engine.calibration.diagnosis import Diagnosis
    from venus3d.engine.calibration.observation import Observation, View
    from venus3d.engine.calibration.projection_uncertainty import projection_diff_px
    from venus3d.engine.errors import (
        BoardError,
        CalibrationError,
        PoseError,
        SourceError,
        StorageError,
        VenusError,
    )
    from venus3d.engine.geometry.board import Board
    from venus3d.engine.geometry.camera import Camera
    from venus3d.engine.geometry.decomposition import Step, decompose
    from venus3d.engine.geometry.lenses import LENSES, LensModel
    from venus3d.engine.geometry.pose import Pose
    from venus3d.engine.guidance.prompts import Prompt, step_prompt
    from venus3d.engine.guidance.session import Session
    from venus3d.engine.guidance.settings import Settings
    from venus3d.engine.guidance.snapshot import Snapshot
    from venus3d.engine.planning.limits import Limits
    from venus3d.engine.planning.settings import PlanningSettings
    from venus3d.engine.planning.suggest import suggest
    from venus3d.engine.planning.target import Target
    from venus3d.scene.pages.guide.viewer import Viewer
    from venus3d.sources.frame import Frame
    from venus3d.sources.images_calibration import calibrate_images as calibrate
    from venus3d.sources.sim import Simulation
    from venus3d.sources.view_errors import ViewErrors
    from venus3d.storage.camera_yaml import read_camera_yaml, write_camera_yaml
    from venus3d.storage.formats import export_camera, import_camera
    from venus3d.storage.formats.record import CameraRecord
    from venus3d.storage.result import write_result
    from venus3d.storage.result_reader import Result, read_result

__version__ = "0.1.0"

# The order is that of the API's page: what is calibrated, how, where to next, live, kept, errors.
__all__ = [  # noqa: RUF022
    "Board",
    "Camera",
    "LENSES",
    "LensModel",
    "Pose",
    "Detector",
    "Observation",
    "View",
    "calibrate",
    "Calibration",
    "Diagnosis",
    "diagnose",
    "projection_diff_px",
    "suggest",
    "Target",
    "PlanningSettings",
    "Limits",
    "decompose",
    "Step",
    "step_prompt",
    "Prompt",
    "Session",
    "Settings",
    "Snapshot",
    "Viewer",
    "Simulation",
    "ViewErrors",
    "Frame",
    "read_camera_yaml",
    "write_camera_yaml",
    "export_camera",
    "import_camera",
    "CameraRecord",
    "read_result",
    "write_result",
    "Result",
    "VenusError",
    "BoardError",
    "CalibrationError",
    "PoseError",
    "SourceError",
    "StorageError",
]

_NAMES_IN = {
    "engine.calibration.checks": ("diagnose",),
    "engine.calibration.detection": ("Detector",),
    "engine.calibration.diagnosis": ("Diagnosis",),
    "engine.calibration.observation": ("Observation", "View"),
    "engine.calibration.projection_uncertainty": ("projection_diff_px",),
    "engine.calibration.calibration": ("Calibration",),
    "engine.errors": (
        "BoardError",
        "CalibrationError",
        "PoseError",
        "SourceError",
        "StorageError",
        "VenusError",
    ),
    "engine.geometry.board": ("Board",),
    "engine.geometry.camera": ("Camera",),
    "engine.geometry.lenses": ("LENSES", "LensModel"),
    "engine.geometry.decomposition": ("Step", "decompose"),
    "engine.geometry.pose": ("Pose",),
    "engine.guidance.prompts": ("Prompt", "step_prompt"),
    "engine.guidance.session": ("Session",),
    "engine.guidance.settings": ("Settings",),
    "engine.guidance.snapshot": ("Snapshot",),
    "engine.planning.limits": ("Limits",),
    "engine.planning.settings": ("PlanningSettings",),
    "engine.planning.suggest": ("suggest",),
    "engine.planning.target": ("Target",),
    "scene.pages.guide.viewer": ("Viewer",),
    "sources.frame": ("Frame",),
    "sources.images_calibration": ("calibrate",),
    "sources.sim": ("Simulation",),
    "sources.view_errors": ("ViewErrors",),
    "storage.camera_yaml": ("read_camera_yaml", "write_camera_yaml"),
    "storage.formats": ("export_camera", "import_camera"),
    "storage.formats.record": ("CameraRecord",),
    "storage.result": ("write_result",),
    "storage.result_reader": ("Result", "read_result"),
}
_NAMED_THERE = {"calibrate": "calibrate_images"}
_MODULE_OF = {name: f"venus3d.{module}" for module, names in _NAMES_IN.items() for name in names}

if not TYPE_CHECKING:  # a type checker would take any name for one of this module's

    def __getattr__(name: str) -> Any:
        """A public name, loaded when it is first used (PEP 562)."""
        if name not in _MODULE_OF:
            raise AttributeError(f"module 'venus3d' has no attribute {name!r}")
        value = getattr(import_module(_MODULE_OF[name]), _NAMED_THERE.get(name, name))
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
