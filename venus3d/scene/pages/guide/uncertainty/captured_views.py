"""The captured views in the scene: a faint sheet at each board pose, coloured by its residuals.

/views/N/sheet, /views/N/outline, /views/N/label      the board in view N
"""

from __future__ import annotations

from venus3d.engine.calibration.observation import View
from venus3d.engine.geometry.board import Board
from venus3d.languages import cached_by_language
from venus3d.render.board_mesh import board_ghost, board_outline
from venus3d.render.colour_scale import colour_of, round_up
from venus3d.render.palette import ground
from venus3d.render.shapes import LabelShape, Shape
from venus3d.scene.pages.guide.uncertainty import texts

_OPACITY, _CHOSEN_OPACITY = 0.28, 0.75


def misfit_end_px(views: tuple[View, ...]) -> float:
    """Upper end of the views' colour scale, pixels; the lower one is 0."""
    return round_up(max((view.rms_px for view in views), default=1.0))


@cached_by_language(maxsize=4)
def captured_view_shapes(
    board: Board, views: tuple[View, ...], chosen: int | None, dark: bool
) -> tuple[Shape, ...]:
    """The board in each view; the chosen one stands out."""
    high, colours = misfit_end_px(views), ground(dark)
    shapes: list[Shape] = []
    for view in views:
        name, marked = f"/views/{view.number}", view.number == chosen
        colour = colour_of(view.rms_px, 0.0, high)
        opacity = _CHOSEN_OPACITY if marked else _OPACITY
        edge = colours.warning if marked else colour
        # Labels at different corners, since the boards of many views overlap.
        corner = view.pose.apply(0.86 * board.outline[view.number % 4])
        text = texts.CAPTURED_VIEW_LABEL.format(number=view.number)
        shapes += [
            board_ghost(board, view.pose, f"{name}/sheet", colour, opacity),
            board_outline(board, view.pose, f"{name}/outline", edge, 3.5 if marked else 1.5),
            LabelShape(f"{name}/label", text, corner, colours.text, in_projection=False),
        ]
    return tuple(shapes)


def view_of(name: str) -> int | None:
    """The number of the view with this sheet; None if there is none."""
    parts = name.split("/")
    is_sheet = len(parts) == 4 and parts[1] == "views" and parts[3] == "sheet"
    return int(parts[2]) if is_sheet and parts[2].isdigit() else None
