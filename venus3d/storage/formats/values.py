"""Numbers, sizes and cameras out of files that others wrote. What is not plausible is refused."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import yaml

from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

LARGEST_SIDE = 100_000
_LARGEST = 1e9
"""No number of a camera is larger."""
DEEPEST = 50
LARGEST_YAML = 2**20
"""Bytes. PyYAML takes seconds for that, and no camera file needs more."""


class _WithoutMerges(yaml.SafeLoader):
    """Merged mappings of merged mappings grow without bounds (\"billion laughs\")."""

    def flatten_mapping(self, node: yaml.MappingNode) -> None:
        """Raises `ValueError` for a merge key instead of following it."""
        if any(key.tag == "tag:yaml.org,2002:merge" for key, _ in node.value):
            raise ValueError("a merge key")


def number(value: Any) -> float:
    """A number, also one that YAML 1.1 takes for text (1e-05). Raises `ValueError`."""
    if isinstance(value, bool) or value is None:
        raise ValueError("not a number")
    return float(value)


def numbers(values: Iterable[Any], count: int) -> list[float]:
    """So many numbers. Raises `ValueError`."""
    given = [number(value) for value in values]
    if len(given) != count:
        raise ValueError(f"{len(given)} numbers instead of {count}")
    return given


def size(width: Any, height: Any) -> tuple[int, int]:
    """A picture's size. Raises `ValueError`, and `StorageError` where there is none."""
    if width is None or height is None:
        raise StorageError(
            "The file does not say for pictures of which size the camera is, in pixels; add the "
            "width and the height as docs/formats.md shows."
        )
    sides = number(width), number(height)
    if not all(side == int(side) and 1 <= side <= LARGEST_SIDE for side in sides):
        raise ValueError("no picture's size")
    return int(sides[0]), int(sides[1])


def camera_of(
    image_size: tuple[int, int],
    K: Any,
    distortion: Iterable[Any],
    *,
    model: str = "the model",
    fisheye: bool = False,
) -> Camera:
    """The camera of a camera matrix and OpenCV's distortion coefficients: up to five, eight or
    twelve, more only if the others are zero; with `fisheye` the four of `cv2.fisheye`. Raises
    `ValueError` and `StorageError`."""
    matrix = np.asarray(K, dtype=np.float64).reshape(3, 3)
    coefficients = np.array([number(value) for value in distortion], dtype=np.float64)
    most = 4 if fisheye else 12
    if np.any(coefficients[most:] != 0):
        raise StorageError(
            f"{model} has {coefficients.size} distortion coefficients, and cameras here have at "
            f"most {most}; calibrate with fewer."
        )
    if abs(matrix[0, 1]) > 1e-9 * abs(matrix[0, 0]):
        raise StorageError(
            f"The camera matrix has a skew of {matrix[0, 1]:g} px, and cameras here have none; "
            "calibrate without skew."
        )
    if np.any(matrix[1, 0] != 0) or np.any(matrix[2] != [0, 0, 1]):
        raise ValueError("no camera matrix")
    focal = [matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]]
    checked([*focal, *coefficients], image_size)
    return Camera.from_opencv(matrix, coefficients, image_size, fisheye=fisheye)


def checked(parameters: Iterable[float], image_size: tuple[int, int]) -> Camera:
    """The camera of up to nine parameters of brown5, of more those. Raises `StorageError` where
    they make none."""
    values = np.zeros(9)
    every = np.array([*parameters], dtype=np.float64)
    if not np.isfinite(every).all():
        raise StorageError("Some of the camera's numbers are not finite; calibrate anew.")
    if (np.abs(every) > _LARGEST).any():
        raise StorageError(
            f"{every[np.abs(every).argmax()]:g} is no number of a camera; look where the file "
            "comes from."
        )
    given = every[:9]
    values[: given.size] = given
    if not (values[:2] > 0).all():
        raise StorageError(
            f"Focal lengths of {values[0]:g} and {values[1]:g} px make no camera; they must be "
            "positive."
        )
    return Camera.from_parameters(values, image_size)


def covariance(content: Any, parameters: int = 9) -> Array | None:
    """A (p, p) covariance, or None. Raises `ValueError`."""
    if content is None:
        return None
    matrix = np.array(content, dtype=np.float64).reshape(parameters, parameters)
    scale = np.sqrt(np.abs(np.outer(np.diag(matrix), np.diag(matrix)))) + 1e-300
    if (
        not np.isfinite(matrix).all()
        or (np.diag(matrix) < 0).any()
        or (np.abs(matrix - matrix.T) > 1e-6 * scale).any()
    ):
        raise ValueError("no covariance")
    return matrix


def text_of(content: bytes) -> str:
    """The text of a file, of limited depth. Raises `ValueError`."""
    text = content.decode("utf-8-sig")
    depth = deepest = 0
    for character in text:
        if character in "[{(":
            depth += 1
            deepest = max(deepest, depth)
        elif character in "]})":
            depth -= 1
    if deepest > DEEPEST:
        raise ValueError("too deep")
    return text


def json_of(content: bytes) -> Mapping[str, Any]:
    """The object of a JSON file. Raises `ValueError`."""
    return mapping(json.loads(text_of(content)))


def yaml_of(content: bytes) -> Mapping[str, Any]:
    """The mapping of a YAML file, also under OpenCV's own first line %YAML:1.0, and with the line
    --- at its end that `ros2 topic echo` leaves. Raises `ValueError`."""
    if len(content) > LARGEST_YAML:
        raise ValueError("too large")
    text = re.sub(r"\A%YAML:.*", "", text_of(content))
    text = re.sub(r"\n---\s*\Z", "\n", text)
    try:
        return mapping(yaml.load(text, _WithoutMerges))
    except yaml.YAMLError as error:
        raise ValueError("no YAML") from error


def mapping(content: Any) -> Mapping[str, Any]:
    """`content` if it is a mapping. Raises `ValueError`."""
    if not isinstance(content, Mapping):
        raise ValueError("no mapping")
    return content


def chosen(cameras: Mapping[str, Any], name: str | None, title: str) -> Any:
    """The camera of this name, or the only one. Raises `StorageError`."""
    if not cameras:
        raise ValueError("no camera")
    if name is None and len(cameras) == 1:
        return next(iter(cameras.values()))
    if name is None or name not in cameras:
        shown = [*cameras][:8]
        listed = ", ".join(shown) + (", …" if len(cameras) > len(shown) else "")
        raise StorageError(
            f"{title} holds {len(cameras)} camera{'s' * (len(cameras) > 1)}; name one of them with "
            f"--name: {listed} "
            "(venus3d import makes a camera.yaml of it)."
        )
    return cameras[name]
