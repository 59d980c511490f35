"""Fixtures for the commands: run one in this process, and make folders of pictures."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from venus3d.cli import main
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.render.board_mesh import board_shape
from venus3d.render.offscreen import Offscreen


@dataclass(frozen=True)
class Ran:
    """What a command left behind."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        """The last line of stdout."""
        return json.loads(self.out.splitlines()[-1])

    @property
    def sentence(self) -> str:
        """The one sentence on stderr, without the program's name; remarks on the way are left out.

        Fails if the command did not end as a user's mistake does.
        """
        assert self.code == 2, (self.code, self.out, self.err)
        lines = [line for line in self.err.splitlines() if line.startswith("venus3d: ")]
        assert len(lines) == 1 and self.err.splitlines()[-1] == lines[0], self.err
        assert "Traceback" not in self.err
        sentence = lines[0].removeprefix("venus3d: ")
        assert sentence.endswith(".") and not sentence[0].islower(), sentence
        return sentence


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str]) -> Callable[..., Ran]:
    """Run `venus3d ARGUMENTS` here; file descriptors are captured, OpenCV's noise included."""

    def call(*arguments: object) -> Ran:
        capfd.readouterr()
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as stop:  # tyro's own answer to options that it cannot parse
            code = int(stop.code or 0)
        out, err = capfd.readouterr()
        return Ran(code, out, err)

    return call


@pytest.fixture(scope="session")
def photographs(
    tmp_path_factory: pytest.TempPathFactory, paper_camera: Camera, default_board: Board
) -> Callable[[str, Sequence[Pose]], Path]:
    """Make a folder of clean pictures of the default board under the given poses."""

    def make(name: str, poses: Sequence[Pose]) -> Path:
        folder = tmp_path_factory.mktemp(name)
        with Offscreen("painter") as offscreen:
            for number, pose in enumerate(poses, start=1):
                shapes = (board_shape(default_board, pose),)
                picture = offscreen.render(paper_camera, shapes, background=(120, 120, 120))
                cv2.imwrite(
                    str(folder / f"{number:02}.png"), cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)
                )
        return folder

    return make


TILTED = [
    (30, 0, 0, 0, 0, 0.45),
    (-30, 10, 5, 0.05, 0, 0.5),
    (5, 35, 0, -0.05, 0.02, 0.45),
    (0, -35, 10, 0, 0.03, 0.5),
    (25, 25, -10, 0.06, -0.03, 0.5),
    (-20, -30, 15, -0.06, 0, 0.4),
]


@pytest.fixture(scope="session")
def tilted_pictures(photographs: Callable[[str, Sequence[Pose]], Path]) -> Path:
    """Six pictures from which the paper's camera can be calibrated."""
    return photographs("tilted", [Pose.from_vector(p) for p in TILTED])


@pytest.fixture
def blank_picture(tmp_path: Path) -> Path:
    """A picture without a board."""
    path = tmp_path / "blank.png"
    cv2.imwrite(str(path), np.full((480, 640, 3), 127, np.uint8))
    return path


@pytest.fixture(scope="session")
def kept_session(tmp_path_factory: pytest.TempPathFactory, tilted_pictures: Path) -> Path:
    """The folder of a session with views of the tilted pictures."""
    return _session(tmp_path_factory.mktemp("sessions") / "kept", tilted_pictures, views=6)


@pytest.fixture(scope="session")
def short_session(tmp_path_factory: pytest.TempPathFactory, tilted_pictures: Path) -> Path:
    """The same with two views: a film takes seconds for each."""
    return _session(tmp_path_factory.mktemp("sessions") / "short", tilted_pictures, views=2)


def _session(folder: Path, pictures: Path, views: int) -> Path:
    asked = ["guide", str(pictures), "--headless", "--method", "random", "--max-views", str(views)]
    assert main([*asked, "--output", str(folder)]) == 0
    return folder
