"""What `guide --from` starts with: the views of a result.json, or a camera from any other file."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import attrgetter
from pathlib import Path

import msgspec
import numpy as np

from venus3d.cli.given import given_over
from venus3d.engine.calibration.observation import whole
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.engine.guidance.known_camera import KnownCamera
from venus3d.engine.guidance.record import SessionState
from venus3d.engine.guidance.views import CapturedView
from venus3d.engine.planning.heuristic_poses import HeuristicState
from venus3d.options import BoardOptions
from venus3d.scene.pages.guide.options import GuideOptions
from venus3d.storage.board_file import board_text
from venus3d.storage.formats import camera_in
from venus3d.storage.formats.record import CameraRecord
from venus3d.storage.result_reader import Result, read_result
from venus3d.storage.session_reader import pictures_of


@dataclass(frozen=True, eq=False)
class KnownStart:
    """One of the two; neither without `--from`."""

    state: SessionState | None = None
    """The views of a result, to go on with."""
    pictures: Mapping[int, Path] = field(default_factory=dict[int, Path])
    """Their pictures, as far as the session is beside the result that captured them."""
    camera: KnownCamera | None = None


def known_start(options: GuideOptions, tell: Callable[[str], None]) -> KnownStart:
    """Read the file of `--from`. Raises `StorageError` if that cannot be, or if its views do not go
    with the other options."""
    if options.known_camera is None:
        return KnownStart()
    path = _file_in(options.known_camera)
    if _is_result(path):
        state = _state_of(read_result(path), options, path)
        tell(f"Going on from the {len(state.views)} views in {path}.")
        return KnownStart(state, pictures_of(path.parent, state.views))
    camera = _camera_of(camera_in(path))
    how = (
        "as well as it says that they are known"
        if camera.has_uncertainty
        else "without knowing how well: the file does not say"
    )
    tell(
        f"Starting from the camera in {path}, {how}. It chooses the first poses; the result is "
        "that of the new views alone."
    )
    return KnownStart(camera=camera)


def with_known_board(options: GuideOptions, arguments: Sequence[str]) -> GuideOptions:
    """With the board of the result that `--from` names, but for the options that the command's
    arguments give. Raises `StorageError`."""
    assert options.known_camera is not None
    path = _file_in(options.known_camera)
    if not _is_result(path):
        return options
    board = msgspec.toml.decode(board_text(_as_given(read_result(path).board)), type=BoardOptions)
    return given_over(replace(GuideOptions(), board=board), "guide", arguments)


def _file_in(path: Path) -> Path:
    """A folder's result.json, where there is one."""
    inside = path / "result.json"
    return inside if inside.is_file() else path


def _is_result(path: Path) -> bool:
    if path.suffix.lower() != ".json" or not path.is_file():
        return False
    try:
        content = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(content, dict) and "captured" in content


def _camera_of(record: CameraRecord) -> KnownCamera:
    covariance = record.covariance
    if covariance is None and record.sigma is not None:
        covariance = np.diag(record.sigma**2)
    return KnownCamera.of(record.camera, covariance)


def _state_of(result: Result, options: GuideOptions, path: Path) -> SessionState:
    board = _as_given(result.board)
    if not _is_same(options.board.board(), board):
        raise StorageError(
            f"The views in {path} are of another board than the options say; leave --board.* out, "
            "or give the camera.yaml beside it to begin without its views."
        )
    found = result.calibration
    seen = [(view.number, whole(view)) for view in found.views]
    seen += [(one.number, one.observation) for one in found.left_out]
    views = tuple(
        CapturedView(number, replace(observation, board=board), None)
        for number, observation in sorted(seen, key=lambda one: one[0])
    )
    if not views:
        raise StorageError(f"{path} has no views; give the camera.yaml beside it.")
    if len(views) >= options.max_views:
        raise StorageError(
            f"{path} has {len(views)} views, and a session ends after {options.max_views}; allow "
            "more by --max-views."
        )
    return SessionState(
        board=board,
        views=views,
        next_view=views[-1].number + 1,
        next_target=len(views) + 1,
        history=(),
        heuristic_state=HeuristicState(),
        skipped=(),
        start=result.camera,
        keep_going=False,
        run=1,
        method=options.method,
        cost=options.cost,
    )


def _as_given(board: Board) -> Board:
    """Without what was found out of its shape."""
    return replace(board, bow=(0.0, 0.0), stretch=0.0)


def _is_same(given: Board, read: Board) -> bool:
    """But for what is read from the pictures."""
    alike = attrgetter("kind", "columns", "rows", "dictionary")
    # Millimetres lose the last digits.
    lengths = [(board.square, board.stretch) for board in (given, read)]
    return alike(given) == alike(read) and np.allclose(*lengths, rtol=1e-9, atol=1e-12)
