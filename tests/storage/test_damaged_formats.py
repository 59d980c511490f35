"""Damaged camera files end in a sentence: OpenCV's and scipy's compiled readers end the process (a
matrix of 3 x -1 numbers, an unknown type of numbers in a .mat file)."""

from __future__ import annotations

import random
import re
import zlib
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat, savemat

from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.storage.formats import FORMATS, export_camera, import_camera
from venus3d.storage.formats.mat5 import numeric_arrays

CAMERA = replace(PAPER_CAMERA, k3=0.0)


def damaged(content: bytes, rng: random.Random) -> Iterator[bytes]:
    """One number changed, one byte changed, or cut off."""
    numbers = [*re.finditer(rb"-?\d+\.?\d*(e-?\d+)?", content)]
    for match in rng.sample(numbers, min(len(numbers), 25)):
        for value in (b"nan", b"1e999", b"-1", b"0", b"x", b"9" * 20, b"[", b""):
            yield content[: match.start()] + value + content[match.end() :]
    for at in rng.sample(range(len(content)), min(len(content), 60)):
        yield content[:at]
        yield content[:at] + bytes([rng.randrange(256)]) + content[at + 1 :]


@pytest.mark.parametrize("name", list(FORMATS))
def test_a_damaged_file_gives_a_camera_or_a_sentence(name: str, tmp_path: Path) -> None:
    path = tmp_path / "camera"
    plain = name in ("blender", "unity")
    export_camera(CAMERA.without_distortion() if plain else CAMERA, path, name)
    for content in damaged(path.read_bytes(), random.Random(0)):
        path.write_bytes(content)
        with suppress(StorageError):
            camera = import_camera(path, name).camera
            assert np.isfinite(camera.parameters).all() and min(camera.image_size) > 0


@pytest.mark.parametrize("name", ["opencv-yaml", "opencv-json", "opencv-xml"])
@pytest.mark.parametrize("columns", ["-1", "0", "2", "4", "2000000000"])
def test_a_matrix_has_as_many_numbers_as_rows_and_columns(
    name: str, columns: str, tmp_path: Path
) -> None:
    path = export_camera(CAMERA, tmp_path / "camera", name)
    path.write_text(re.sub(r"(cols\W+)3\b", rf"\g<1>{columns}", path.read_text(), count=1))
    with pytest.raises(StorageError, match="There is no camera"):
        import_camera(path, name)


def test_an_unknown_type_of_numbers_in_a_mat_file(tmp_path: Path) -> None:
    path = export_camera(CAMERA, tmp_path / "camera.mat")
    content = path.read_bytes()
    at = content.index(b"intrinsicMatrix") + 16
    for kind in (0x9E, 0, 8, 10, 14, 15, 99):
        path.write_bytes(content[:at] + bytes([kind]) + content[at + 1 :])
        with pytest.raises(StorageError, match="There is no camera"):
            import_camera(path)


@pytest.mark.parametrize("compressed", [False, True])
def test_the_arrays_are_scipys(tmp_path: Path, compressed: bool) -> None:
    """Of all types of numbers, also packed, with other kinds of content and large arrays between;
    a packed array that is larger than memory is not unpacked."""
    path = tmp_path / "many.mat"
    kinds = ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8")
    content = {f"a_{kind}": np.arange(6).reshape(2, 3).astype(kind) for kind in kinds}
    other = {"text": "words", "cell": np.array([1, "a"], dtype=object), "s": {"x": 1.0}}
    large = {"large": np.zeros((600, 600)), "last": np.array([[7.5]])}
    savemat(path, {**content, **other, **large}, do_compression=compressed)
    found = numeric_arrays(path.read_bytes(), [*content, "last"], 100)
    assert found.keys() == {*content, "last"}
    for name, values in found.items():
        np.testing.assert_array_equal(values, loadmat(path)[name])
    for name in ("large", "text", "cell"):
        with pytest.raises(ValueError, match=r"too large|no real numbers"):
            numeric_arrays(path.read_bytes(), [name], 100)
    bomb = zlib.compress(bytes(50_000_000))
    header = path.read_bytes()[:128]
    packed = header + np.array([15, len(bomb)], "<u4").tobytes() + bomb
    assert numeric_arrays(packed, ["a"], 100) == {}
