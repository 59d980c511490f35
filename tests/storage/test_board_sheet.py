"""The board on paper: its shapes, true scale in every format, tiles, the page for a screen."""

from __future__ import annotations

import io
import re
from dataclasses import replace

import cv2
import numpy as np
import pypdfium2
import pytest
from numpy.typing import NDArray
from PIL import Image

from venus3d.engine.calibration.board_finding import find_boards
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.storage.board_sheet.files import pdf_of, picture_of_sheet, png_of, svg_of
from venus3d.storage.board_sheet.screen import screen_page
from venus3d.storage.board_sheet.sheet import Sheet, lay_out, paper_size, tiles

A4 = (210.0, 297.0)
CODE = 'kind = "charuco"\ncolumns = 9\nrows = 6\n'
DPI = 200
Grey = NDArray[np.uint8]


def sheet_of(board: Board, paper: tuple[float, float] | None = A4) -> Sheet:
    return lay_out(board, paper, words=("some words",), code=CODE)


def pages_of(pdf: bytes) -> list[Grey]:
    document = pypdfium2.PdfDocument(pdf)
    drawn = [document[i].render(scale=DPI / 72).to_pil().convert("L") for i in range(len(document))]
    return [np.asarray(page, dtype=np.uint8) for page in drawn]


def opencv_corners(board: Board, picture: Grey) -> NDArray[np.float64]:
    """(40, 2) corners in order of their ids, pixels; found by OpenCV."""
    read = 255 - picture if board.inverted else picture
    corners, ids, _, _ = cv2.aruco.CharucoDetector(board.cv_board).detectBoard(read)
    assert ids is not None and np.asarray(ids).size == board.corner_count
    return np.asarray(corners).reshape(-1, 2)[np.argsort(np.asarray(ids).ravel())]


def assert_true_scale(board: Board, corners: NDArray[np.float64], dpi: float) -> None:
    metres = corners / (dpi / 0.0254)
    off = metres - metres.mean(axis=0) - (board.corners - board.corners.mean(axis=0))[:, :2]
    assert np.abs(off).max() < 1e-4, "a tenth of a millimetre"


@pytest.mark.parametrize(
    "board",
    [
        Board(7, 5, 0.02, 0.014),
        Board(8, 6, 0.02, 0.014, legacy=True),
        Board(6, 6, 0.02, 0.012, "DICT_4X4_50", inverted=True, first_id=7),
    ],
)
def test_the_shapes_are_those_that_opencv_prints(board: Board) -> None:
    side = 60
    scale = side / board.square
    drawn = np.zeros((board.rows * side, board.columns * side), dtype=bool)
    corner = np.array([board.width / 2, board.height / 2, 0, 0])
    for x, y, w, h in board.of_kind.drawing(board).rectangles + corner:
        x0, y0, x1, y1 = np.rint(np.array([x, y, x + w, y + h]) * scale).astype(int)
        assert not drawn[y0:y1, x0:x1].any(), "no shape lies over another"
        drawn[y0:y1, x0:x1] = True
    printed = replace(board, inverted=False).texture(side)
    np.testing.assert_array_equal(drawn, printed < 128)


@pytest.mark.parametrize("inverted", [False, True])
def test_a_pdf_has_its_size_its_ruler_and_its_code(inverted: bool) -> None:
    board = Board(inverted=inverted)
    sheet = sheet_of(board)
    assert (sheet.width, sheet.height) == A4[::-1], "it fits A4, turned"
    (page,) = pages_of(pdf_of(sheet, tiles(sheet, A4), "board"))
    assert_true_scale(board, opencv_corners(board, page), DPI)
    # The ruler below the board: from the first dark pixel of its rows to where the code begins.
    foot = page[int((210 - 5.5 - 17) / 25.4 * DPI) :][: int(3 / 25.4 * DPI)]
    dark = np.flatnonzero((foot < 128).any(axis=0))
    ruler = dark[: np.flatnonzero(np.diff(dark) > 2 / 25.4 * DPI)[0] + 1]
    assert (ruler[-1] - ruler[0] + 1) / DPI * 25.4 == pytest.approx(100, abs=0.15)
    text, *_ = cv2.QRCodeDetector().detectAndDecode(page[-int(24 / 25.4 * DPI) :])
    assert text == CODE


@pytest.mark.parametrize(
    "board",
    [
        Board(8, 6, 0.025, 0.015, kind="circles"),
        Board(4, 9, 0.016, 0.014, kind="asymmetric-circles"),
    ],
)
def test_circles_are_printed_where_they_belong(board: Board) -> None:
    sheet = sheet_of(board)
    (page,) = pages_of(pdf_of(sheet, tiles(sheet, A4), "board"))
    picture, dpi = picture_of_sheet(sheet_of(board, None), 150, 1000 * board.square)
    for drawn, resolution in ((page, DPI), (picture, dpi)):
        shifted = board.kind == "asymmetric-circles"
        layout = cv2.CALIB_CB_ASYMMETRIC_GRID if shifted else cv2.CALIB_CB_SYMMETRIC_GRID
        of_any_size = cv2.SimpleBlobDetector.Params()
        of_any_size.maxArea = 1e5
        blobs = cv2.SimpleBlobDetector.create(of_any_size)
        size = (board.columns, board.rows)
        cv2.setRNGSeed(0)  # the search is random: with other numbers it misses some grids
        found, centres = cv2.findCirclesGrid(drawn, size, flags=layout, blobDetector=blobs)
        assert found
        corners = np.reshape(centres, (-1, 2))
        corners = corners if corners[0, 0] < corners[1, 0] else corners[::-1]
        assert_true_scale(board, corners, resolution)


@pytest.mark.parametrize(
    "board",
    [
        Board(9, 6, 0.02, 0.015),
        Board(8, 6, 0.02, 0.015, legacy=True, inverted=True),
        Board(9, 6, 0.018, kind="chessboard"),
        Board(9, 6, 0.02, 0.01, kind="circles"),
        Board(9, 6, 0.02, 0.01, kind="circles", inverted=True),
        Board(4, 11, 0.018, 0.009, kind="asymmetric-circles"),
        Board(4, 11, 0.018, 0.009, kind="asymmetric-circles", inverted=True),
        Board(6, 6, 0.028, 0.0215, "DICT_APRILTAG_36H11", kind="aprilgrid"),
        Board(5, 6, 0.03, 0.024, "DICT_6X6_50", first_id=3, kind="aruco-grid"),
    ],
    ids=lambda board: board.kind + "-inverted" * board.inverted,
)
def test_a_printed_sheet_is_read_as_the_board_it_is(board: Board) -> None:
    """The mark for the top was taken for a circle, and letters and codes outnumbered the others."""
    words = ("a grid of circles with many letters, 9 x 6, 20 mm / 10 mm", "Print at 100 %.")
    sheet = lay_out(board, A4, words=words, code=5 * CODE)
    (page,) = pages_of(pdf_of(sheet, tiles(sheet, A4), "board"))
    for times in (1, 2, 3):
        size = page.shape[1] // times, page.shape[0] // times
        picture = np.asarray(cv2.resize(page, size, interpolation=cv2.INTER_AREA), np.uint8)
        seen = Detector(board).detect(picture)
        assert seen.count == board.corner_count and not seen.board_diagnoses
        (found,) = find_boards([picture])
        assert (found.kind, {found.columns, found.rows}, found.first_id) == (
            board.kind,
            {board.columns, board.rows},
            board.first_id,
        )


def test_a_large_board_comes_on_several_pages_that_fit_together() -> None:
    board = Board(12, 9, 0.05, 0.037)
    sheet = sheet_of(board)
    parts = tiles(sheet, A4)
    assert sum(t.width * t.height for t in parts) == pytest.approx(sheet.width * sheet.height)
    whole = np.full((round(sheet.height / 25.4 * DPI), round(sheet.width / 25.4 * DPI)), 255, "u1")
    for tile, page in zip(parts, pages_of(pdf_of(sheet, parts, "board")), strict=True):
        assert tile.page in (A4, A4[::-1])
        left, top = (tile.page[0] - tile.width) / 2, (tile.page[1] - tile.height) / 2
        assert min(left, top) >= 10 - 1e-9, "room for the marks"
        x0, y0, x1, y1 = (
            round(mm / 25.4 * DPI)
            for mm in (tile.left, tile.top, tile.left + tile.width, tile.top + tile.height)
        )
        px, py = round(left / 25.4 * DPI), round(top / 25.4 * DPI)
        x1, y1 = min(x1, whole.shape[1]), min(y1, whole.shape[0])
        whole[y0:y1, x0:x1] = page[py : py + y1 - y0, px : px + x1 - x0]
        outside = page.copy()
        outside[py - 2 : py + y1 - y0 + 2, px - 2 : px + x1 - x0 + 2] = 255
        assert (outside < 128).any(), "marks to cut by"
    assert_true_scale(board, opencv_corners(board, whole), DPI)


def test_a_png_has_whole_squares_and_the_same_scale() -> None:
    board = Board()
    picture, dpi = picture_of_sheet(sheet_of(board, None), 150, 28)
    with Image.open(io.BytesIO(png_of(picture, dpi))) as image:
        assert image.info["dpi"][0] == pytest.approx(dpi, abs=0.02)
        np.testing.assert_array_equal(np.asarray(image.convert("L")) < 128, picture < 128)
    assert dpi / 25.4 * 28 == pytest.approx(round(dpi / 25.4 * 28))
    assert_true_scale(board, opencv_corners(board, picture), dpi)


def test_an_svg_has_the_same_shapes() -> None:
    sheet = sheet_of(Board())
    svg = svg_of(sheet, "a <board>")
    assert "a &lt;board&gt;" in svg and "rule='evenodd" in svg
    assert "width='297.0000mm' height='210.0000mm' viewBox='0 0 297.0000 210.0000'" in svg
    found = re.findall(r"M([\d.]+) ([\d.]+)h([\d.]+)v([\d.]+)h-", svg)
    np.testing.assert_allclose(np.array(found, dtype=float), sheet.rectangles, atol=1e-4)


def test_only_the_board_without_a_code() -> None:
    sheet = lay_out(Board(), None, margin=12)
    assert (sheet.width, sheet.height) == pytest.approx((252 + 24, 168 + 24))
    assert not sheet.texts and not sheet.polygons
    assert len(sheet.rectangles) == len(Board().of_kind.drawing(Board()).rectangles)


def test_papers() -> None:
    assert paper_size("A3") == (297, 420) and paper_size("500x700") == (500, 700)
    assert paper_size("fit") is None
    for wrong in ("a5", "0x100", "nanx10", "10x", "1e9x10"):
        with pytest.raises(StorageError, match="a4, a3, letter, fit"):
            paper_size(wrong)


def test_resolution_that_makes_no_picture() -> None:
    sheet = sheet_of(Board())
    with pytest.raises(StorageError, match="too coarse"):
        picture_of_sheet(sheet, 10, 28)
    with pytest.raises(StorageError, match="over 400 million pixels"):
        picture_of_sheet(sheet, 10000, 28)
    with pytest.raises(StorageError, match="must be a number from 1"):
        picture_of_sheet(sheet, float("nan"), 28)


def test_the_page_for_a_screen_is_whole() -> None:
    page = screen_page(Board())
    assert "__" not in page.replace("__proto__", "") and "http:" not in page.replace(
        "http://www.w3.org/2000/svg", ""
    )
    assert '{"square-mm": 28.0, "marker-mm": 21.0}' in page
