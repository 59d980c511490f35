"""`venus3d decompose`: a pose as four steps, in words and images."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from venus3d.cli.options import DecomposeOptions
from venus3d.cli.report import print_note
from venus3d.engine.amounts import signed, signed_tenth, size_mm
from venus3d.engine.errors import PoseError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.decomposition import HOME_DISTANCE, Step, Steps, decompose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.engine.planning.limits import Limits, refusals
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.storage.folder import prepare
from venus3d.storage.formats import camera_in
from venus3d.storage.products import product_place, write_product

PICTURE_WIDTH = 960
_MADE = "a step"


def decompose_command(options: DecomposeOptions) -> None:
    """Print the steps and write their images. Raises `VenusError` for a user's mistake."""
    board = options.board.board()
    options.limits.check()
    camera = PAPER_CAMERA if options.camera is None else camera_in(options.camera).camera
    target = _target(options, board, camera)
    folder = prepare(options.output)
    for number in range(1, 5):
        product_place(_step_file(folder, number), _MADE)
    steps = decompose(target, camera, board)
    print(_heading(target, board))
    for step in steps:
        print(_step_text(step))
    for path in _write_pictures(folder, steps, camera, board):
        print(f"Written: {path}")


def _target(options: DecomposeOptions, board: Board, camera: Camera) -> Pose:
    millimetres = (options.xt, options.yt, options.zt)
    vector = [options.xr, options.yr, options.zr, *(length / 1000 for length in millimetres)]
    target = Pose.from_vector(vector, axes=options.axes)
    if max(abs(angle) for angle in vector[:3]) > 360:
        raise PoseError("An angle beyond 360° is a mistake; give XR YR ZR in degrees.")
    if options.zt <= 0:
        raise PoseError(
            f"The board's centre would be {abs(options.zt):g} mm behind the lens; ZT must be "
            "positive."
        )
    limits = replace(Limits.for_board(board, camera), **options.limits.chosen())
    refused = refusals(limits, camera, board, target.vector())
    if refused:
        cure = "choose another pose"
        if refused[0].kind not in ("outside", "behind"):
            cure += ", or move the limit (--limits)"
        raise PoseError(f"{refused[0].text.rstrip('.')}; {cure}.")
    return target


def _heading(target: Pose, board: Board) -> str:
    x, y = (signed(1000 * length) for length in target.t[:2])
    xr, yr, zr = (signed_tenth(angle) for angle in target.vector()[:3])
    return (
        f"Target: turned {xr}° about X, {yr}° about Y, {zr}° about Z (the camera's axes);\n"
        f"        centre {x} mm right, {y} mm down, {size_mm(1000 * target.t[2])} in front.\n"
        f"From the upright, frontal board, {size_mm(1000 * HOME_DISTANCE)} in front of the camera:"
    )


def _step_text(step: Step) -> str:
    lines = [
        f"\nStep {step.number} of 4",
        f"  camera: {step_prompt(step).camera}",
        f"  holder: {step_prompt(step).holder}",
    ]
    if step.corners_outside:
        lines.append(f"  Mind: {len(step.corners_outside)} corners leave the picture here.")
    return "\n".join(lines)


def _write_pictures(folder: Path, steps: Steps, camera: Camera, board: Board) -> list[Path]:
    size = (PICTURE_WIDTH, round(PICTURE_WIDTH * camera.height / camera.width))
    with Offscreen() as offscreen:
        if offscreen.note:
            print_note(offscreen.note)
        projections = Projections(offscreen)
        pictures = [
            projections.of_step(step, camera, board, size=size, dark=False) for step in steps
        ]
        return [
            write_product(_step_file(folder, step.number), _png(picture.result()), _MADE)
            for step, picture in zip(steps, pictures, strict=True)
        ]


def _step_file(folder: Path, number: int) -> Path:
    return folder / f"step-{number}.png"


def _png(picture: NDArray[np.uint8]) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(picture).save(buffer, "PNG")
    return buffer.getvalue()
