"""H.264 as it comes over a bad line: no picture that shows damage is passed on.

A damaged picture stayed in all that followed, up to the next key frame, as grey smears and
displaced blocks; only the first was told, or none.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from av.video.frame import PictureType
from numpy.typing import NDArray

from tests.waiting import wait_until
from venus3d.engine.errors import SourceError
from venus3d.sources.live import Live
from venus3d.sources.stream import StreamCapture

PACKET = 188
"""Bytes of a packet of a transport stream."""
WHOLE_AT_FIRST = 60
GROUP, COUNT = 30, 90
"""Pictures from one key frame to the next, and in all."""
Pictures = list[NDArray[np.uint8]]
Damage = Callable[[list[bytearray], random.Random], list[bytearray]]


def some_lost(packets: list[bytearray], rng: random.Random) -> list[bytearray]:
    return [p for n, p in enumerate(packets) if n < WHOLE_AT_FIRST or rng.random() > 0.002]


def some_changed(packets: list[bytearray], rng: random.Random) -> list[bytearray]:
    for packet in packets[WHOLE_AT_FIRST:]:
        if rng.random() < 0.002:
            for _ in range(20):
                packet[rng.randrange(20, PACKET)] ^= 255
    return packets


@pytest.fixture(scope="module", params=["", "zerolatency"])
def stream(
    request: pytest.FixtureRequest, shared_data: Path, tmp_path_factory: pytest.TempPathFactory
) -> tuple[bytes, Pictures]:
    """A real video as H.264 in a transport stream, and its pictures as they are decoded."""
    path = tmp_path_factory.mktemp("stream") / "whole.ts"
    with (
        av.open(str(shared_data / "wpilib-charuco-12x8.mp4")) as video,
        av.open(str(path), "w", format="mpegts") as written,
    ):
        sent = written.add_stream("libx264", rate=30)
        sent.width, sent.height, sent.pix_fmt = 640, 360, "yuv420p"
        # With zerolatency a picture is made of several slices.
        tune = {"tune": request.param} if request.param else {"bf": "0"}
        sent.options = {"g": str(GROUP), "preset": "veryfast", **tune}
        for number, frame in zip(range(COUNT), video.decode(video=0), strict=False):
            small = frame.reformat(640, 360, "yuv420p")
            small.pts, small.time_base = number, Fraction(1, 30)
            small.pict_type = PictureType.NONE
            written.mux(sent.encode(small))
        written.mux(sent.encode())
    return path.read_bytes(), received(StreamCapture(str(path)))


def received(capture: StreamCapture) -> Pictures:
    found: Pictures = []
    with pytest.raises(SourceError, match="has ended"):
        while True:
            found.append(capture.read()[1])
    capture.release()
    return found


def is_shown(picture: NDArray[np.uint8], pictures: Pictures) -> bool:
    """Whether it is one of them."""
    return any(np.array_equal(picture, one) for one in pictures)


def damaged(content: bytes, damage: Damage, seed: int, path: Path) -> Path:
    """A file of the stream as it comes over a bad line."""
    packets = [bytearray(content[n : n + PACKET]) for n in range(0, len(content), PACKET)]
    path.write_bytes(b"".join(damage(packets, random.Random(seed))))
    return path


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_no_picture_is_shown_of_which_a_part_was_lost(
    stream: tuple[bytes, Pictures], seed: int, tmp_path: Path
) -> None:
    content, whole = stream
    assert len(whole) == COUNT
    capture = StreamCapture(str(damaged(content, some_lost, seed, tmp_path / "lost.ts")))
    shown = received(capture)
    assert all(is_shown(picture, whole) for picture in shown)
    assert capture.damaged > 0 and COUNT - 3 <= len(shown) + capture.damaged <= COUNT + 3
    assert len(shown) > 0, "it goes on with the next key frame"


def test_most_of_what_was_changed_on_the_way_is_not_shown(
    stream: tuple[bytes, Pictures], tmp_path: Path
) -> None:
    """Some of it can be decoded into a picture like any other: no decoder can tell that."""
    content, whole = stream
    bad = left_out = good = 0
    for seed in range(4):
        capture = StreamCapture(str(damaged(content, some_changed, seed, tmp_path / "x.ts")))
        are_whole = [is_shown(picture, whole) for picture in received(capture)]
        good, bad = good + sum(are_whole), bad + are_whole.count(False)
        left_out += capture.damaged
    assert bad < 0.3 * (bad + left_out) and good > 0


def test_the_count_reaches_the_live_source(stream: tuple[bytes, Pictures], tmp_path: Path) -> None:
    path = damaged(stream[0], some_lost, 1, tmp_path / "lost.ts")
    source = Live(lambda: StreamCapture(str(path)), "a bad line")
    try:
        wait_until(lambda: source.damaged > 0)
    finally:
        source.close()
