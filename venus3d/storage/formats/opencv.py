"""OpenCV's FileStorage (YAML, JSON, XML) with the keys of its calibration sample.

Written by https://github.com/opencv/opencv, samples/cpp/.../camera_calibration.cpp; camera.yaml is
of this format. There is no key for a covariance; the standard deviations stand beside.
"""

from __future__ import annotations

import re
from datetime import datetime, timezone
from typing import cast

import cv2
import numpy as np

from venus3d.engine.errors import BoardError
from venus3d.engine.geometry.board import KINDS, Board, Kind
from venus3d.engine.geometry.pose import Array
from venus3d.storage.formats import values
from venus3d.storage.formats.record import CameraFormat, CameraRecord

_LENSES = ("brown5", "rational", "rational-thin-prism", "fisheye")
_MOST = 1000
"""Numbers in a matrix: more are no camera's."""
_IN_MEMORY = cv2.FILE_STORAGE_MEMORY
_FLAG_OF = {
    "yaml": cv2.FILE_STORAGE_FORMAT_YAML,
    "json": cv2.FILE_STORAGE_FORMAT_JSON,
    "xml": cv2.FILE_STORAGE_FORMAT_XML,
}


def opencv_text(record: CameraRecord, extension: str = "yaml") -> str:
    """The text of such a file. Pixels as in OpenCV; the board's lengths in metres."""
    camera, board = record.camera, record.board
    flags = cv2.FILE_STORAGE_WRITE | _IN_MEMORY | _FLAG_OF[extension]
    file = cv2.FileStorage(f"camera.{extension}", flags)
    file.writeComment("Camera calibration by venus3d. Pixel centres have integer coordinates.")
    file.write("calibration_time", datetime.now(timezone.utc).isoformat(timespec="seconds"))
    file.write("image_width", camera.width)
    file.write("image_height", camera.height)
    file.write("camera_matrix", camera.K)
    # One row, k1 k2 p1 p2 k3 ..., as in OpenCV's sample; of cv2.fisheye k1 k2 k3 k4.
    if not camera.lens.is_perspective:
        file.write("fisheye_model", 1)
    file.write("lens_model", camera.lens.name)
    file.write("distortion_coefficients", camera.distortion.reshape(1, -1))
    if record.sigma is not None:
        file.writeComment(
            f"Standard deviations of {' '.join(camera.parameter_names)}; 0: was held fixed."
        )
        file.write("standard_deviations", np.reshape(record.sigma, (1, -1)))
    if record.rms_px is not None:
        file.write("avg_reprojection_error", record.rms_px)
    if record.views is not None:
        file.write("nframes", record.views)
    if board is not None:
        file.write("board_width", board.columns)
        file.write("board_height", board.rows)
        file.write("square_size", board.square)
        file.write("board_kind", board.kind)
        if board.has("marker"):
            file.write("marker_size", board.marker)
        if board.has("dictionary"):
            file.write("aruco_dictionary", board.dictionary)
        for name in ("legacy", "inverted", "first_id"):
            if board.has(name):
                file.write(f"board_{name}", int(getattr(board, name)))
    return file.releaseAndGetString()


def read_opencv(content: bytes, _name: str | None = None) -> CameraRecord:
    """The camera of such a file, ours or the sample's, in YAML, JSON or XML."""
    text = values.text_of(content)
    # OpenCV's parsers call themselves for each level, and end the process when the stack does.
    if text.lstrip().startswith("<") and _xml_depth(text) > values.DEEPEST:
        raise ValueError("too deep")
    try:
        file = cv2.FileStorage(text, cv2.FILE_STORAGE_READ | _IN_MEMORY)
    except (cv2.error, SystemError) as error:
        raise ValueError("no file of OpenCV") from error
    try:
        return _record_of(file)
    except cv2.error as error:
        raise ValueError("no camera") from error
    finally:
        file.release()


def _record_of(file: cv2.FileStorage) -> CameraRecord:
    K, distortion = (_matrix(file, key) for key in ("camera_matrix", "distortion_coefficients"))
    if K is None or distortion is None:
        raise ValueError("no camera matrix")
    width, height = _number(file, "image_width"), _number(file, "image_height")
    fisheye = bool(_number(file, "fisheye_model"))
    camera = values.camera_of(
        values.size(width, height), K, distortion.ravel(), model="The file", fisheye=fisheye
    )
    sigma, views = _matrix(file, "standard_deviations"), _number(file, "nframes")
    return CameraRecord(
        camera,
        sigma=None if sigma is None or sigma.size != len(camera.parameters) else sigma.ravel(),
        rms_px=_number(file, "avg_reprojection_error"),
        views=None if views is None else int(views),
        board=_board_of(file),
    )


def _board_of(file: cv2.FileStorage) -> Board | None:
    """The board, if it is one of ours; a file without its kind is of a time with one kind."""
    kind, dictionary = file.getNode("board_kind"), file.getNode("aruco_dictionary")
    sides = [_number(file, key) for key in ("board_width", "board_height", "square_size",
                                            "marker_size")]  # fmt: skip
    columns, rows, square, marker = (-1.0 if side is None else side for side in sides)
    name = kind.string() if kind.isString() else "charuco"
    if name not in KINDS or min(columns, rows, square) < 0:
        return None
    if not dictionary.isString() and "dictionary" in KINDS[name].fields:
        return None
    try:
        return Board(
            columns=int(columns),
            rows=int(rows),
            square=square,
            marker=marker,
            dictionary=dictionary.string() if dictionary.isString() else "",
            legacy=bool(_number(file, "board_legacy")),
            inverted=bool(_number(file, "board_inverted")),
            first_id=int(_number(file, "board_first_id") or 0),
            kind=cast(Kind, name),
        )
    except BoardError:
        return None


def _matrix(file: cv2.FileStorage, key: str) -> Array | None:
    # `mat()` writes beyond its memory where rows and columns are not as many as the numbers.
    node = file.getNode(key)
    if not node.isMap():
        return None
    content, rows, columns = (node.getNode(part) for part in ("data", "rows", "cols"))
    shape = int(rows.real()), int(columns.real())
    if not content.isSeq() or min(shape) < 1 or content.size() != shape[0] * shape[1]:
        raise ValueError("not as many numbers as rows and columns")
    numbers = [content.at(number) for number in range(min(content.size(), _MOST + 1))]
    if len(numbers) > _MOST or not all(one.isInt() or one.isReal() for one in numbers):
        raise ValueError("no small matrix of numbers")
    return np.array([one.real() for one in numbers]).reshape(shape)


def _number(file: cv2.FileStorage, key: str) -> float | None:
    node = file.getNode(key)
    return float(node.real()) if node.isInt() or node.isReal() else None


def _xml_depth(text: str) -> int:
    depth = deepest = 0
    for tag in re.finditer(r"<(/?)[A-Za-z_]", text):
        depth += -1 if tag[1] else 1
        deepest = max(deepest, depth)
    return deepest


def _format(
    extension: str, title: str, file_name: str, names: tuple[str, ...], mark: bytes
) -> CameraFormat:
    """One of OpenCV's three formats; `mark` is what its files hold and no others."""
    return CameraFormat(
        f"opencv-{extension}",
        title,
        file_name,
        names,
        write=lambda record: opencv_text(record, extension).encode(),
        read=read_opencv,
        recognises=lambda content: mark in content,
        keeps_sigma=True,
        lenses=_LENSES,
    )


OPENCV_YAML = _format(
    "yaml", "OpenCV's YAML", "camera.yaml", ("camera.yaml", "camera.yml"), b"!!opencv-matrix"
)
OPENCV_JSON = _format(
    "json", "OpenCV's JSON", "camera-opencv.json", ("*-opencv.json",), b'"opencv-matrix"'
)
OPENCV_XML = _format("xml", "OpenCV's XML", "camera.xml", ("*.xml",), b"<opencv_storage")
