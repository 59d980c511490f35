"""result.json is what docs/result-format.md says, and can be read back."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.scene.guided import guided_session
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.checks import diagnose
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.storage.result import full_result, summary_of, to_json, write_result
from venus3d.storage.result_reader import read_result

PARAMETERS = PAPER_CAMERA.parameter_names

DOCUMENT = Path(__file__).parents[2] / "docs" / "result-format.md"
LAYOUT = Diagnosis("wrong-layout", "The layout is the old one.", "Say so.", (2,))


@pytest.fixture(scope="module")
def session(paper_camera: Camera, default_board: Board) -> Snapshot:
    return guided_session(paper_camera, default_board, Settings(method="pose-selection"))


def keys_of(content: Any, path: str = "") -> Iterator[str]:
    """The paths of all keys: `board.rows`, `captured[].ids`; parameters' names are values."""
    if isinstance(content, Mapping) and set(content) != set(PARAMETERS):
        for key, value in content.items():
            yield f"{path}{key}"
            yield from keys_of(value, f"{path}{key}.")
    elif isinstance(content, list):
        for value in content:
            yield from keys_of(value, f"{path.removesuffix('.')}[].")


def test_every_key_is_described(session: Snapshot, paper_camera: Camera) -> None:
    """A simulated session with every optional part, against the table of the document."""
    assert session.calibration is not None and session.forecast is not None
    summary = summary_of(
        session.calibration,
        diagnoses=[LAYOUT],
        converged=False,
        truth=paper_camera,
        forecast=session.forecast,
    )
    result = json.loads(to_json(full_result(summary, session.calibration, session.history)))
    rows = re.findall(r"^\| `(\S+)` \|.*", DOCUMENT.read_text(), re.MULTILINE)
    assert len(rows) == len(set(rows))
    assert set(rows) == set(keys_of(result))
    short = re.findall(r"^\| `(\S+)` \|.*\| yes \|[^|]*\|$", DOCUMENT.read_text(), re.MULTILINE)
    assert set(short) == set(keys_of(json.loads(to_json(summary))))
    assert result["schema"] == 2


def test_a_result_is_read_back(tmp_path: Path, calibration: Calibration) -> None:
    diagnoses = (*diagnose(calibration), LAYOUT)
    plain = read_result(write_result(tmp_path / "plain.json", calibration))
    assert plain.diagnoses == diagnose(calibration)
    path = write_result(tmp_path / "r.json", calibration, warnings=["w"], diagnoses=diagnoses)
    result = read_result(path)
    assert result.schema == 2 and result.warnings == ("w",) and result.diagnoses == diagnoses
    assert result.camera == calibration.camera and result.board == calibration.board
    np.testing.assert_array_equal(result.covariance, calibration.covariance)
    again = result.calibration
    assert again.rms_px == calibration.rms_px and again.free == calibration.free
    assert again.residual_sigma_px == calibration.residual_sigma_px
    for seen, view, read in zip(result.observations, calibration.views, again.views, strict=True):
        np.testing.assert_array_equal(seen.ids, view.observation.ids)
        np.testing.assert_array_equal(seen.corners, view.observation.corners)
        assert seen.image_size == (1280, 720) and seen.name == view.observation.name
        np.testing.assert_allclose(read.pose.matrix, view.pose.matrix, atol=1e-12)
        np.testing.assert_array_equal(read.errors, view.errors)
        assert read.number == view.number and read.rms_px == view.rms_px


@pytest.mark.parametrize(
    "text",
    [
        "",
        "hello",
        "[]",
        "3",
        "{}",
        '{"schema": 2}',
        '{"schema": 1}',
        '{"schema": true}',
        "\x00\x01",
        "[" * 100_000,
    ],
    ids=range(10),
)
def test_a_file_that_is_no_result(tmp_path: Path, text: str) -> None:
    path = tmp_path / "result.json"
    path.write_text(text)
    with pytest.raises(StorageError, match=r"is no result of venus3d.* give a result\.json"):
        read_result(path)
    with pytest.raises(StorageError, match=r"cannot be read \(no such file or directory\)"):
        read_result(tmp_path / "absent.json")
    with pytest.raises(StorageError, match="cannot be read"):
        read_result(tmp_path)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("free", [True]),
        ("covariance", [[1]]),
        ("image_size", [0, 0]),
        ("image_size", [float("inf"), 720]),
        ("image_circle", "round"),
        ("image_circle", [640, 360]),
        ("image_circle", [640, 360, -300]),
        ("image_circle", [float("inf"), 360, 300]),
        ("board", {}),
        ("intrinsics", {"fx": "wide"}),
        ("captured", [{"ids": [99]}]),
    ],
)
def test_a_damaged_result(
    tmp_path: Path, calibration: Calibration, key: str, value: object
) -> None:
    content = full_result(summary_of(calibration), calibration)
    path = tmp_path / "result.json"
    path.write_text(json.dumps({**content, key: value}))
    with pytest.raises(StorageError, match="is no result of venus3d"):
        read_result(path)


@pytest.mark.parametrize(
    ("schema", "cure"), [(None, r"read the camera\.yaml beside it"), (3, "update venus3d")]
)
def test_another_schema(
    tmp_path: Path, calibration: Calibration, schema: int | None, cure: str
) -> None:
    content = full_result(summary_of(calibration), calibration)
    del content["schema"]
    path = tmp_path / "result.json"
    path.write_text(to_json(content if schema is None else {**content, "schema": schema}))
    with pytest.raises(StorageError, match=f"has schema {schema or 1}, .* {cure}"):
        read_result(path)
