"""A video on a server: the frames that OpenCV reads from the same file, fetched once, and no
picture of another size among them."""

from __future__ import annotations

import http.server
import io
import threading
from collections.abc import Iterator
from pathlib import Path

import av
import cv2
import numpy as np
import pytest

from tests.sources.test_recordings import all_frames, picture, quarter_turned, write_video
from venus3d.engine.errors import SourceError
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.video import Video


class Server:
    """Sends files as web servers do, from any place in them; notes from where."""

    def __init__(self, folder: Path) -> None:
        server, self.asked = self, list[int]()

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                content = (folder / self.path.strip("/")).read_bytes()
                asked = self.headers.get("Range", "bytes=0-").removeprefix("bytes=").split("-")[0]
                begin = int(asked or 0)
                server.asked.append(begin)
                self.send_response(206)
                self.send_header("Accept-Ranges", "bytes")
                end = f"bytes {begin}-{len(content) - 1}/{len(content)}"
                self.send_header("Content-Range", end)
                self.send_header("Content-Length", str(len(content) - begin))
                self.end_headers()
                for at in range(begin, len(content), 4096):
                    try:
                        self.wfile.write(content[at : at + 4096])
                    except OSError:  # the reader looks elsewhere
                        return

            def log_message(self, format: str, *args: object) -> None:
                pass

        self._http = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.address = f"http://127.0.0.1:{self._http.server_port}"
        threading.Thread(target=self._http.serve_forever, args=(0.02,), daemon=True).start()

    def close(self) -> None:
        self._http.shutdown()
        self._http.server_close()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    server = Server(tmp_path)
    yield server
    server.close()


def encoded(path: Path, sizes: list[tuple[int, int]], kind: str) -> None:
    """A video whose size changes every 30 frames."""
    content = bytearray()
    for size in sizes:
        part = io.BytesIO()
        with av.open(part, "w", format=kind) as container:
            stream = container.add_stream("libx264", rate=20, options={"preset": "ultrafast"})
            stream.width, stream.height = size
            stream.pix_fmt = "yuv420p"
            for number in range(30):
                image = picture(number, size)
                container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="bgr24")))
            container.mux(stream.encode())
        content += part.getvalue()
    path.write_bytes(content)


@pytest.mark.parametrize("kind", ["mp4", "mpegts"])
def test_the_frames_are_those_that_opencv_reads(server: Server, tmp_path: Path, kind: str) -> None:
    """Each of them once, at its time, in its colours up to the rounding of the two; asked for as
    one reader does: the beginning, what stands at the end, then all from the beginning."""
    path = tmp_path / "video"
    encoded(path, [(160, 120)], kind)
    source = open_frame_source(f"{server.address}/video")
    assert isinstance(source, Video) and source.image_size == (160, 120)
    assert source.announced == pytest.approx(30, abs=1)
    frames, own = all_frames(source), all_frames(Video(path))
    assert len(server.asked) <= 3
    assert len(frames) == len(own) == 30
    for frame, same in zip(frames, own, strict=True):
        assert frame.time_s == pytest.approx(same.time_s, abs=0.002)
        assert np.abs(frame.image.astype(int) - same.image).mean() < 1.5


def test_another_size_is_refused(server: Server, tmp_path: Path) -> None:
    encoded(tmp_path / "video", [(160, 120), (320, 240)], "mpegts")
    with pytest.raises(SourceError, match="to 320 x 240 px at about frame 31; cut it"):
        all_frames(open_frame_source(f"{server.address}/video"))  # type: ignore[arg-type]


def test_a_phones_tag_turns_it_as_opencv_does(server: Server, tmp_path: Path) -> None:
    path = quarter_turned(write_video(tmp_path / "portrait.mp4"))
    source = open_frame_source(f"{server.address}/portrait.mp4")
    assert isinstance(source, Video) and source.image_size == (240, 320)
    assert "turned by 90 degrees" in source.notes[0]
    capture = cv2.VideoCapture(str(path))
    capture.set(cv2.CAP_PROP_ORIENTATION_AUTO, 1)
    good, first = capture.read()
    frame = source.read()
    source.close()
    assert good and frame is not None
    assert np.abs(frame.image.astype(int) - first).mean() < 1.5
