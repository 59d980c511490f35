"""What pictures show instead of the board asked for, and what to do, in sentences.

What a picture shows is found out by `board_recognition`.
"""

from __future__ import annotations

from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.marker_lattice import Lattice
from venus3d.engine.calibration.marker_numbering import Numbering
from venus3d.engine.calibration.marker_reading import Markers
from venus3d.engine.calibration.plain_patterns import Pattern
from venus3d.engine.calibration.thin_borders import Border
from venus3d.engine.geometry.board import KINDS, Board
from venus3d.engine.sentences import Sentence

_NOT_READ = Sentence(
    "Such a pattern is not read: print a board (venus3d board) and take the pictures with it."
)
_READ_IT = Sentence(
    "If that is your board, start with {options}; venus3d board --find tells the rest."
)
_KIND_OF = {
    "checkerboard": "chessboard",
    "circles": "circles",
    "asymmetric circles": "asymmetric-circles",
}
MEASURE_TAGS = Sentence(
    "Measure a tag and the distance from one tag's edge to the same edge of the next, and give "
    "both: --board.marker-mm {found} --board.square-mm {square}, if that is right. If the tags are "
    "as given, expose less: overexposed white spreads into them."
)
_PLAIN = {
    "checkerboard": Sentence(
        "The picture shows a checkerboard of {columns} x {rows} inner corners, without markers: "
        "not the board asked for."
    ),
    "circles": Sentence(
        "The picture shows a grid of {columns} x {rows} circles: not the board asked for."
    ),
    "asymmetric circles": Sentence(
        "The picture shows an asymmetric grid of circles, {rows} rows of {columns}: not the board "
        "asked for."
    ),
    "unread": Sentence(
        "The picture shows a board of {columns} x {rows} inner corners, but its markers cannot be "
        "read: they are too small or blurred, or their dictionary is none of OpenCV's."
    ),
}
_SECOND = {
    "charuco": Sentence("a ChArUco board of {columns} x {rows} squares, {name}, ids from {first}"),
    "aprilgrid": Sentence("an AprilGrid of {columns} x {rows} tags, {name}, ids from {first}"),
    "aruco-grid": Sentence("a grid of {columns} x {rows} markers of {name}, ids from {first}"),
    "chessboard": Sentence("a checkerboard of {columns} x {rows} squares"),
    "circles": Sentence("a grid of {columns} x {rows} circles"),
    "asymmetric-circles": Sentence("an asymmetric grid of circles, {rows} rows of {columns}"),
}
_SECOND_PART = {
    "charuco": Sentence("a part of a ChArUco board with markers of {name}"),
    "aprilgrid": Sentence("a part of an AprilGrid with tags of {name}"),
    "aruco-grid": Sentence("a part of a grid of markers of {name}"),
}
_THIN = {
    "black": Sentence(
        "The markers of the board in the picture are of {dictionary}, but their black border is "
        "too thin for them to be found: it must be as wide as one of a marker's cells."
    ),
    "white": Sentence(
        "The markers of the board in the picture are of {dictionary}, but the white border around "
        "them is too thin for them to be found: they nearly fill their squares."
    ),
}


def swapped_size_diagnosis(board: Board, numbering: Numbering) -> Diagnosis:
    """The markers lie as on a board of other columns or rows."""
    asked = Sentence("not as on the board of {columns} columns and {rows} rows asked for").format(
        columns=board.columns, rows=board.rows
    )
    first = numbering.first_id if numbering.whole else 0
    if board.rows in numbering.columns:
        cause = Sentence(
            "The markers lie as on a board of {columns} columns, {asked}: the two are swapped."
        ).format(columns=board.rows, asked=asked)
        cure = _start_with(board, board.rows, board.columns, first)
    elif len(numbering.columns) == 1:
        columns = numbering.columns[0]
        cause = Sentence("The markers lie as on a board of {columns} columns, {asked}.").format(
            columns=columns, asked=asked
        )
        cure = (
            _start_with(board, columns, numbering.rows, first)
            if numbering.whole
            else Sentence(
                "Count the rows as well and start with --board.columns {columns} --board.rows ROWS."
            ).format(columns=columns)
        )
    else:
        cause = Sentence("Markers of {dictionary} are seen, but they lie {asked}.").format(
            dictionary=board.dictionary, asked=asked
        )
        cure = Sentence(
            "Count the columns and rows and start with --board.columns and --board.rows."
        )
    return Diagnosis("swapped-size", cause, cure)


def _start_with(board: Board, columns: int, rows: int, first_id: int) -> Sentence:
    if first_id == board.first_id:
        return Sentence("Start with --board.columns {columns} --board.rows {rows}.").format(
            columns=columns, rows=rows
        )
    return Sentence(
        "Start with --board.columns {columns} --board.rows {rows} --board.first-id {first}."
    ).format(columns=columns, rows=rows, first=first_id)


def marker_size_diagnosis(asked: Board, board: Board) -> Diagnosis:
    """The markers have another size than asked for, and are read in that."""
    values = {"found": board.marker * 1000, "square": board.square * 1000}
    return Diagnosis(
        "wrong-marker-size",
        Sentence(
            "In the pictures the markers are about {found:g} mm wide where a square is {square:g} "
            "mm, not {given:g} mm; they are read that way."
        ).format(**values, given=asked.marker * 1000),
        Sentence(
            "Measure a marker and a square and give both: --board.marker-mm {found:g} "
            "--board.square-mm {square:g}, if that is right."
        ).format(**values),
    )


def tag_size_diagnosis(asked: Board, board: Board) -> Diagnosis:
    """The tags of a grid have another size than asked for, and are read in that."""
    found, square = f"{board.marker * 1000:g}", f"{board.square * 1000:g}"
    return Diagnosis(
        "wrong-marker-size",
        Sentence(
            "In the pictures the tags are about {found} mm wide where it is {square} mm from one "
            "tag to the next, not {given} mm; they are read that way."
        ).format(found=found, square=square, given=f"{asked.marker * 1000:g}"),
        MEASURE_TAGS.format(found=found, square=square),
    )


def two_boards_diagnosis() -> Diagnosis:
    """Two equal boards in view."""
    return Diagnosis(
        "two-boards",
        Sentence("The picture shows the same markers twice, on two equal boards."),
        Sentence("Cover one of the boards, or take it away."),
    )


def second_board_diagnosis(
    kind: str, size: tuple[int, int] | None, dictionary: str, first_id: int, options: str
) -> Diagnosis:
    """Another board is in view beside the one that is read.

    Args:
        size: columns and rows, as `--board.columns` and `--board.rows` count; None if only a part
            is seen.
        options: to read it instead.
    """
    columns, rows = size or (0, 0)
    other = (_SECOND if size else _SECOND_PART)[kind].format(
        columns=columns, rows=rows, name=dictionary, first=first_id
    )
    cure = Sentence("Only the board asked for is used: cover the other one, or take it away.")
    if size:
        cure = Sentence(
            "Only the board asked for is used: cover the other one, or take it away. If it is the "
            "one you mean, start with {options}."
        ).format(options=options)
    return Diagnosis(
        "second-board",
        Sentence("Beside the board asked for, another one is in view: {board}.").format(
            board=other
        ),
        cure,
    )


def first_id_diagnosis(board: Board) -> Diagnosis:
    """The markers start at another id than asked for, and are read."""
    return Diagnosis(
        "other-first-id",
        Sentence(
            "The markers of the board of {columns} x {rows} start at id {first}; it is read that "
            "way."
        ).format(columns=board.columns, rows=board.rows, first=board.first_id),
        Sentence("Start with --board.first-id {first} to be sure.").format(first=board.first_id),
    )


def missing_rows_diagnosis(asked: Board, board: Board) -> Diagnosis:
    """The markers start at another id than asked for, and only the rows that both have are read."""
    return Diagnosis(
        "other-first-id",
        Sentence(
            "The markers of the board of {columns} x {rows} start at id {first}, not at {asked}: "
            "some of its rows are not read."
        ).format(
            columns=board.columns, rows=board.rows, first=board.first_id, asked=asked.first_id
        ),
        Sentence("Start with --board.first-id {first}.").format(first=board.first_id),
    )


def wrong_dictionary_diagnosis(board: Board, markers: Markers, size: Numbering | None) -> Diagnosis:
    """The markers are of another dictionary than asked for."""
    cure = Sentence("Start with --board.dictionary {name}.").format(name=markers.dictionary)
    if size is not None and size.whole and len(size.columns) == 1:
        columns, rows = size.columns[0], size.rows
        if (columns, rows) != (board.columns, board.rows):
            cure = Sentence(
                "Start with --board.columns {columns} --board.rows {rows} --board.dictionary "
                "{name}."
            ).format(columns=columns, rows=rows, name=markers.dictionary)
    return Diagnosis(
        "wrong-dictionary",
        Sentence(
            "The picture shows markers of {name} ({count} different ones), not of {asked}."
        ).format(name=markers.dictionary, count=markers.distinct, asked=board.dictionary),
        cure,
    )


def mirrored_diagnosis(dictionary: str, count: int) -> Diagnosis:
    """The pictures are mirrored; flipped they show so many markers."""
    return Diagnosis(
        "mirrored",
        Sentence(
            "The pictures are mirrored: flipped left to right, they show {count} markers of {name}."
        ).format(count=count, name=dictionary),
        Sentence(
            "Switch mirroring off in the camera's program, or start with --flip; the camera file "
            "then holds for pictures that are flipped back."
        ),
    )


def some_mirrored_diagnosis() -> Diagnosis:
    """Some of the pictures are mirror images of the board."""
    return Diagnosis(
        "mirrored",
        Sentence(
            "Some pictures are mirrored: the board is found in them only after they are flipped "
            "left to right. They are left out."
        ),
        Sentence(
            "Flip them back, or calibrate them by themselves with --flip if the camera or its "
            "program mirrors what it shows."
        ),
    )


def charuco_diagnosis(lattice: Lattice, numbering: Numbering, dictionary: str) -> Diagnosis:
    """The picture shows a ChArUco board where another kind is asked for."""
    columns = numbering.columns[0] if numbering.columns else lattice.columns
    cause = Sentence(
        "The picture shows a ChArUco board of {columns} x {rows} squares, {name}: not the board "
        "asked for."
    ).format(columns=columns, rows=lattice.rows, name=dictionary)
    cure = _options("charuco", columns, lattice.rows, dictionary)
    return Diagnosis("other-pattern", cause, cure)


def tag_grid_diagnosis(kind: str, lattice: Lattice, dictionary: str) -> Diagnosis:
    """The picture shows an "aprilgrid" or an "aruco-grid" where another board is asked for."""
    values = {"columns": lattice.columns, "rows": lattice.rows}
    if kind == "aprilgrid":
        cause = Sentence(
            "The picture shows an AprilGrid of {columns} x {rows} tags, {tags}: not the board "
            "asked for."
        ).format(**values, tags=dictionary.partition("APRILTAG_")[2])
    else:
        cause = Sentence(
            "The picture shows a grid of {columns} x {rows} markers of {name}: not the board "
            "asked for."
        ).format(**values, name=dictionary)
    first = int(lattice.ids.min())
    cure = _options(kind, lattice.columns, lattice.rows, dictionary, first)
    return Diagnosis("other-pattern", cause, cure)


def single_markers_diagnosis(board: Board, markers: Markers) -> Diagnosis:
    """The picture shows markers that lie in no order."""
    return Diagnosis(
        "other-pattern",
        Sentence(
            "The picture shows {count} single markers of {name}: not the board of {asked} asked "
            "for."
        ).format(count=markers.distinct, name=markers.dictionary, asked=board.dictionary),
        _NOT_READ,
    )


def small_board_diagnosis(width_px: float, needed_px: float) -> Diagnosis:
    """The board's squares are too small to be read."""
    return Diagnosis(
        "small-board",
        Sentence(
            "The board is in the picture, but too small to be read: its squares are {width} px "
            "wide, and {needed} px are needed."
        ).format(width=f"{width_px:.0f}", needed=f"{needed_px:.0f}"),
        Sentence("Bring it nearer, take pictures with more pixels, or print larger squares."),
    )


def unread_border_diagnosis(board: Board, border: Border) -> Diagnosis:
    """A border of the board's markers is too thin for them to be found."""
    return Diagnosis(
        "unread-markers",
        _THIN[border].format(dictionary=board.dictionary),
        Sentence("Print the board again with venus3d board, and measure it."),
    )


def plain_pattern_diagnosis(board: Board, pattern: Pattern) -> Diagnosis | None:
    """That the picture shows a pattern without markers; None if it is the board asked for, or may
    be a part of it."""
    cause = _PLAIN[pattern.kind].format(columns=pattern.columns, rows=pattern.rows)
    if pattern.kind == "unread":
        return Diagnosis(
            "unread-markers",
            cause,
            Sentence(
                "Bring the board nearer and hold it still; if that does not help, print a board "
                "with venus3d board."
            ),
        )
    more = 1 if pattern.kind == "checkerboard" else 0  # squares, not inner corners
    columns, rows, kind = pattern.columns + more, pattern.rows + more, _KIND_OF[pattern.kind]
    if board.kind == kind:
        if {board.columns, board.rows} == {columns, rows}:
            if more == 0 and pattern.white != board.inverted:
                return _polarity_diagnosis(pattern.white)
            return None  # hard to see, or read the other way round
        # Parts of an asymmetric grid are found as grids, with either side as their rows. Of the
        # others the whole alone is, and a size that was given too large is named.
        stride = board.of_kind.stride
        own, seen = (
            sorted((stride * one, other))
            for one, other in ((board.columns, board.rows), (columns, rows))
        )
        if stride > 1 and seen[0] <= own[0] and seen[1] <= own[1]:
            return None
    return Diagnosis("other-pattern", cause, _options(kind, columns, rows, inverted=pattern.white))


def _polarity_diagnosis(white: bool) -> Diagnosis:
    """The circles are those asked for, but white instead of black, or black instead of white."""
    if white:
        cause = Sentence(
            "The circles in the picture are white on a dark board, not black on white."
        )
        cure = Sentence("Start with --board.inverted.")
    else:
        cause = Sentence(
            "The circles in the picture are black on white, not white on a dark board."
        )
        cure = Sentence("Leave out --board.inverted.")
    return Diagnosis("wrong-polarity", cause, cure)


def _options(
    kind: str,
    columns: int,
    rows: int,
    dictionary: str = "",
    first_id: int = 0,
    *,
    inverted: bool = False,
) -> str:
    """How to have a board read as what it is, if its kind is read."""
    if kind not in KINDS:
        return _NOT_READ
    options = f"--board.kind {kind} --board.columns {columns} --board.rows {rows}"
    options += f" --board.dictionary {dictionary}" if dictionary else ""
    options += f" --board.first-id {first_id}" if first_id else ""
    options += " --board.inverted" * inverted
    return _READ_IT.format(options=options)
