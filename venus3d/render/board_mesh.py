"""The board as one mesh (printed front, white rim, thin body, neutral back), its outline and ghost.
One mesh, so that a moving board is one node and one pose; layout and picture are the engine's."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import trimesh
from PIL import Image, ImageDraw

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.boards.drawing import painted
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.languages import cached_by_language
from venus3d.render import texts
from venus3d.render.print_offset import PrintOffset
from venus3d.render.shapes import Colour, LineShape, MeshShape
from venus3d.render.text_drawing import font

RIM = 0.3
"""Width of the unprinted rim around the squares, in squares."""
THICKNESS = 0.004
"""Of the board's body, metres."""
BODY_COLOUR: Colour = (150, 152, 156)
LARGEST_TEXTURE_PX = 4096
_WHITE = 14
"""Of the greys from 0 in a board's picture; with the body's colour they are 16, of 4 bits each."""
_CELLS = 24
"""Along each side of a bowed sheet: a bow of 3 mm is then drawn to 0.005 mm."""
_BACK_PX = 512
"""Width of the back's picture."""


def board_shape(
    board: Board, pose: Pose, name: str = "/board/live", offset: PrintOffset | None = None
) -> MeshShape:
    """The textured board at `pose` (`T_camera_board`), its print displaced by `offset`."""
    return MeshShape(name, board_mesh(board, offset), pose, textured=True)


def held_board(board: Board, pose: Pose) -> tuple[MeshShape, MeshShape]:
    """The board at `pose`, and what its back says to whoever holds it."""
    back = MeshShape("/board/back", _back_mesh(board), pose, textured=True, in_projection=False)
    return board_shape(board, pose), back


@lru_cache(maxsize=8)
def board_mesh(board: Board, offset: PrintOffset | None = None) -> trimesh.Trimesh:
    """Textured mesh in the board's frame, metres; the front lies in z = 0, but for a bow, and faces
    -z. The same board gives the same object, so renderers may cache it."""
    picture, px, printed = _atlas(replace(board, bow=(0.0, 0.0), stretch=0.0))
    width, height = board.width / 2 + RIM * board.square, board.height / 2 + RIM * board.square
    front = np.array([[-width, -height], [width, -height], [width, height], [-width, height]])
    faces = [np.column_stack([front, np.zeros(4)])]
    # Sides and back are separate quads, with texture coordinates of their own.
    back = np.column_stack([front, np.full(4, THICKNESS)])
    faces.append(back[::-1])
    for i in range(4):
        j = (i + 1) % 4
        faces.append(np.array([faces[0][j], faces[0][i], back[i], back[j]]))

    size = np.array(picture.size, dtype=np.float64)
    # The board's centre in the picture from its upper left edge: one square of rim, then the print.
    centre = printed / 2 + px
    scale = px / board.square
    front_uv = (front * scale + centre) / size
    body_uv = np.full((20, 2), np.array([size[0] / 2, size[1] - 0.5 * px]) / size)
    uv = np.vstack([front_uv, body_uv])
    if any(board.bow) or board.stretch or offset is not None:
        front = _cells(width, height)
        sheet = np.column_stack([front, np.zeros(len(front))])
        shift = np.tensordot([*board.bow, board.stretch], board.deformations(sheet), 1)
        if offset is not None:
            shift[:, :2] += offset.at(front)
        # The body stays flat, behind the sheet.
        body = np.vstack(faces[1:])
        body[:, 2] += max(0.0, float(shift[:, 2].max()))
        faces = [sheet + shift, body]
        uv = np.vstack([(front * scale + centre) / size, body_uv])
    uv[:, 1] = 1 - uv[:, 1]  # texture v points upwards

    return _textured(np.vstack(faces), uv, picture)


def _cells(width: float, height: float) -> Array:
    """(4 N, 2) corners of the cells that a bowed sheet of +-width by +-height is drawn with."""
    x, y = np.linspace(-width, width, _CELLS + 1), np.linspace(-height, height, _CELLS + 1)
    left, top = (a.ravel() for a in np.meshgrid(x[:-1], y[:-1]))
    right, bottom = (a.ravel() for a in np.meshgrid(x[1:], y[1:]))
    corners = [(left, top), (right, top), (right, bottom), (left, bottom)]
    return np.stack([np.stack(corner, axis=1) for corner in corners], axis=1).reshape(-1, 2)


def _textured(vertices: Array, uv: Array, picture: Image.Image) -> trimesh.Trimesh:
    """A mesh of quads, four vertices (4 N, 3) each, with their places in the picture (4 N, 2)."""
    quads = np.arange(len(vertices)).reshape(-1, 4)
    visual: Any = vars(trimesh)["visual"]  # its annotations omit this module
    material = visual.material.PBRMaterial(
        baseColorTexture=picture, metallicFactor=0.0, roughnessFactor=1.0
    )
    return trimesh.Trimesh(
        vertices=vertices,
        faces=np.vstack([quads[:, [0, 2, 1]], quads[:, [0, 3, 2]]]),
        visual=visual.TextureVisuals(uv=uv, material=material),
        process=False,
    )


@cached_by_language(maxsize=8)
def _back_mesh(board: Board) -> trimesh.Trimesh:
    """A sheet on the board's back that names its edges, read from behind: the holder's left is the
    board's +x."""
    w, h = board.width / 2, board.height / 2
    corners = np.array([[w, -h], [-w, -h], [-w, h], [w, h]])
    vertices = np.column_stack([corners, np.full(4, THICKNESS + 0.0005)])
    size = (_BACK_PX, round(_BACK_PX * h / w))
    picture = Image.new("RGB", size, BODY_COLOUR)
    draw, face = ImageDraw.Draw(picture), font(size[1] // 9, bold=True)
    for text, x, y, anchor in (
        (texts.TOP, 0.5, 0.04, "ma"),
        (texts.LEFT, 0.03, 0.5, "lm"),
        (texts.RIGHT, 0.97, 0.5, "rm"),
    ):
        draw.text((x * size[0], y * size[1]), text, fill=(40, 42, 46), font=face, anchor=anchor)
    uv = np.array([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]])
    return _textured(vertices, uv, picture)


@lru_cache(maxsize=8)
def _atlas(board: Board) -> tuple[Image.Image, int, Array]:
    """Picture (board, a rim one square wide, a row of body colour); px per square; (2,) width and
    height of what is within the rim, px.

    A square is a power of two wide, so that at every mipmap level down to one texel per square
    texel edges lie on the squares' edges and filtering moves no corner. Those of tags lie between
    texels, hence greys: in black and white a tag was up to a texel smaller or larger. A palette
    makes the browser's PNG ten times as fast to encode, which blocks the scene.
    """
    px = 128
    while px > 16 and max(board.columns + 3, board.rows + 4) * px > LARGEST_TEXTURE_PX:
        px //= 2
    rim = 0 if board.inverted else _WHITE
    columns, rows = (int(np.ceil(side / board.square - 1e-6)) for side in board.of_kind.size(board))
    size = columns * board.square, rows * board.square
    printed = painted(board.of_kind.drawing(board), size, px / board.square)
    greys = 255 - printed if board.inverted else printed
    numbers = np.full(((rows + 3) * px, (columns + 2) * px), rim, dtype=np.uint8)
    numbers[px : (rows + 1) * px, px : (columns + 1) * px] = np.rint(greys * (_WHITE / 255))
    numbers[(rows + 2) * px :] = _WHITE + 1
    picture = Image.fromarray(numbers).convert("P")
    palette = np.rint(np.arange(_WHITE + 1) * (255 / _WHITE)).astype(int)
    picture.putpalette([*np.repeat(palette, 3).tolist(), *BODY_COLOUR])
    return picture, px, np.array([columns, rows]) * float(px)


@lru_cache(maxsize=8)
def ghost_mesh(board: Board) -> trimesh.Trimesh:
    """The printed area as a single sheet (a closed body would blend twice), board frame, metres."""
    return trimesh.Trimesh(
        vertices=board.outline, faces=np.array([[0, 2, 1], [0, 3, 2]]), process=False
    )


@lru_cache(maxsize=8)
def outline_segments(board: Board) -> Array:
    """(4, 2, 3) edges of the printed area, board frame, metres."""
    return np.stack([board.outline, np.roll(board.outline, -1, axis=0)], axis=1)


def board_outline(
    board: Board, pose: Pose, name: str, colour: Colour, width_px: float = 2.0
) -> LineShape:
    """The edges of the printed area at `pose`."""
    return LineShape(name, outline_segments(board), pose, colour, width_px)


def board_ghost(
    board: Board, pose: Pose, name: str, colour: Colour, opacity: float = 0.35
) -> MeshShape:
    """The printed area as a translucent sheet at `pose`."""
    return MeshShape(name, ghost_mesh(board), pose, colour, opacity)
