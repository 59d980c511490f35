"""Folders, patterns, images and videos; and what they say when they cannot be read."""

from __future__ import annotations

import io
import re
import struct
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from PIL import Image

from venus3d.engine.errors import SourceError
from venus3d.sources.folder import Folder
from venus3d.sources.frame import Frame
from venus3d.sources.live import Live
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.opencv_log import silence_opencv
from venus3d.sources.video import Video


def picture(seed: int = 0, size: tuple[int, int] = (64, 48)) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 255, (size[1], size[0], 3), np.uint8)


def write_video(path: Path, codec: str = "mp4v", frames: int = 20, rate: float = 20.0) -> Path:
    """Frame n is of the grey value 12 n, so that a decoded frame tells its number."""
    silence_opencv()  # FFmpeg asks once how much to say
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*codec), rate, (320, 240))
    for number in range(frames):
        writer.write(np.full((240, 320, 3), 12 * number, np.uint8))
    writer.release()
    return path


def quarter_turned(path: Path) -> Path:
    """An MP4 of `write_video` with a phone's tag: a quarter turn clockwise."""
    content = bytearray(path.read_bytes())
    # The track's matrix, in 16.16 and 2.30 numbers.
    at = content.index(b"tkhd") + 4 + 40
    content[at : at + 36] = struct.pack(
        ">9i", 0, 1 << 16, 0, -(1 << 16), 0, 0, 240 << 16, 0, 1 << 30
    )
    path.write_bytes(content)
    return path


def all_frames(source: Folder | Video | Live) -> list[Frame]:
    frames: list[Frame] = []
    while (frame := source.read()) is not None:
        frames.append(frame)
    source.close()
    source.close()
    assert source.read() is None
    return frames


def sentence(spec: object) -> str:
    """What a user reads: one line, one sentence."""
    with pytest.raises(SourceError) as caught:
        all_frames(open_frame_source(str(spec)))
    text = str(caught.value)
    assert "\n" not in text and text.endswith(".")
    return text


# -- images ------------------------------------------------------------------------------------


def test_a_folder_is_read_in_the_order_people_count(tmp_path: Path):
    for number in (10, 2, 1):
        cv2.imwrite(str(tmp_path / f"shot{number}.png"), picture(number))
    (tmp_path / "notes.txt").write_text("no image, and not named like one")
    (tmp_path / ".hidden.png").write_bytes(b"")
    source = open_frame_source(str(tmp_path))
    assert source.image_size == (64, 48) and not source.is_live
    frames = all_frames(source)
    assert [f.name for f in frames] == ["shot1.png", "shot2.png", "shot10.png"]
    assert [f.time_s for f in frames] == [0, 1, 2]
    np.testing.assert_array_equal(frames[1].image, picture(2))


def test_a_pattern_and_a_single_image(tmp_path: Path):
    for name in ("a1.png", "a2.png", "b1.png"):
        cv2.imwrite(str(tmp_path / name), picture())
    assert [f.name for f in all_frames(open_frame_source(f"{tmp_path}/a*.png"))] == [
        "a1.png",
        "a2.png",
    ]
    assert [f.name for f in all_frames(open_frame_source(f"{tmp_path}/b1.png"))] == ["b1.png"]
    assert [f.name for f in all_frames(open_frame_source(f"file://{tmp_path}/b1.png"))] == [
        "b1.png"
    ]


@pytest.mark.parametrize("suffix", [".png", ".tif", ".pgm"])
def test_grey_and_sixteen_bits_are_kept(tmp_path: Path, suffix: str):
    deep = np.random.default_rng(0).integers(0, 65535, (48, 64), np.uint16)
    cv2.imwrite(str(tmp_path / f"deep{suffix}"), deep)
    (frame,) = all_frames(open_frame_source(str(tmp_path / f"deep{suffix}")))
    assert frame.image.dtype == np.uint16
    np.testing.assert_array_equal(frame.image, deep)


def test_sixteen_bit_colour_keeps_its_depth_as_grey(tmp_path: Path):
    deep = np.random.default_rng(0).integers(0, 65535, (48, 64, 3), np.uint16)
    cv2.imwrite(str(tmp_path / "deep.png"), deep)
    (frame,) = all_frames(open_frame_source(str(tmp_path / "deep.png")))
    grey = deep @ np.array([0.114, 0.587, 0.299])
    assert frame.image.dtype == np.uint16 and frame.image.ndim == 2
    assert np.abs(frame.image - grey).max() < 4


def test_the_orientation_tag_does_not_turn_the_sensor(tmp_path: Path):
    """A phone's portrait shots are landscape files with a tag; turned, fx and fy would swap."""
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.fromarray(picture()[..., ::-1]).save(tmp_path / "portrait.jpg", exif=exif, quality=95)
    source = open_frame_source(str(tmp_path / "portrait.jpg"))
    assert source.image_size == (64, 48)
    assert all_frames(source)[0].image_size == (64, 48)


def test_a_phone_video_is_turned_as_its_tag_says(tmp_path: Path):
    """OpenCV and FFmpeg turn such a video for whoever uses the camera file afterwards."""
    size = (320, 240)
    path = quarter_turned(write_video(tmp_path / "portrait.mp4"))
    source = Video(path)
    assert source.image_size == (size[1], size[0])
    assert all(f.image_size == (size[1], size[0]) for f in all_frames(source))
    (note,) = source.notes
    assert "turned by 90 degrees" in note and f"{size[1]} x {size[0]} px" in note


def test_images_of_several_sizes_name_files_and_sizes(tmp_path: Path):
    for number in range(5):
        cv2.imwrite(str(tmp_path / f"{number}.png"), picture(number))
    cv2.imwrite(str(tmp_path / "odd.png"), picture(9, (32, 32)))
    assert sentence(tmp_path) == (
        "The images have 2 sizes (odd.png: 32 x 32 px; 0.png, 1.png, 2.png and 2 more: "
        "64 x 48 px); keep one size, one camera has only one."
    )


def test_files_that_are_no_image_or_not_all_of_one(tmp_path: Path):
    text = tmp_path / "text.jpg"
    text.write_text("hello")
    assert sentence(text) == (
        f"{text} is not an image, whatever its name says; use a PNG, JPEG, TIFF or BMP file."
    )
    assert sentence(tmp_path) == sentence(text), "the same inside a folder"
    text.unlink()

    for suffix, told in ((".jpg", "breaks off early"), (".png", "is damaged or incomplete")):
        whole = tmp_path / f"whole{suffix}"
        cv2.imwrite(str(whole), picture(0, (640, 480)))
        whole.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
        assert told in sentence(whole)
        whole.unlink()

    empty = tmp_path / "empty.png"
    empty.touch()
    assert sentence(empty) == f"The file {empty} is empty; record or copy it again."


def test_floating_point_images_are_refused(tmp_path: Path):
    path = tmp_path / "float.tiff"
    cv2.imwrite(str(path), np.zeros((48, 64), np.float32))
    assert "float32" in sentence(path)


def test_nothing_there(tmp_path: Path):
    assert sentence(tmp_path) == (
        f"The folder {tmp_path} holds no images; "
        "it needs PNG, JPEG, TIFF or BMP files right inside it."
    )
    assert sentence(f"{tmp_path}/*.png") == (
        f"No file matches {tmp_path}/*.png; check the pattern, and quote it in the shell."
    )
    assert sentence("nowhere/at-all") == (
        "There is no file or folder nowhere/at-all; give an existing video, image or folder, a "
        "pattern of images, a camera's number or a stream's address (guide also takes sim)."
    )
    assert "empty" in sentence(" ")


def test_real_stills(shared_data: Path):
    source = open_frame_source(str(shared_data / "lifecam-charuco-8x8"))
    frames = all_frames(source)
    assert source.image_size == (1280, 720)
    assert [f.name for f in frames] == [f"{n:02d}.jpg" for n in range(1, 17)]
    assert all(f.image.dtype == np.uint8 and f.image.ndim == 3 for f in frames)


# -- videos ------------------------------------------------------------------------------------


@pytest.mark.parametrize(("codec", "suffix"), [("mp4v", ".mp4"), ("MJPG", ".avi")])
def test_every_frame_comes_once_with_the_video_s_own_time(tmp_path: Path, codec: str, suffix: str):
    source = open_frame_source(str(write_video(tmp_path / f"m{suffix}", codec)))
    frames = all_frames(source)
    assert isinstance(source, Video) and source.image_size == (320, 240) and not source.notes
    assert len(frames) == 20
    np.testing.assert_allclose([f.time_s for f in frames], np.arange(20) / 20, atol=1e-6)
    np.testing.assert_allclose([f.image.mean() for f in frames], 12 * np.arange(20), atol=5)
    assert frames[7].name == "frame 8"


def test_a_late_reader_of_a_playing_video_skips_frames(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The wall's clock is replaced, so that nothing here depends on how busy the machine is."""
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    monkeypatch.setattr("time.sleep", lambda s: now.__setitem__(0, now[0] + s))
    source = Video(write_video(tmp_path / "m.mp4"), realtime=True)
    first, second = source.read(), source.read()
    assert first is not None and second is not None
    assert now[0] == pytest.approx(100.05), "an early reader waits for the frame's time"
    now[0] = 100.52
    late = source.read()
    assert late is not None and late.time_s == pytest.approx(0.5)
    assert late.image.mean() == pytest.approx(120, abs=5), "the picture belongs to its time"
    now[0] = 200.0
    assert source.read() is None


def test_a_video_that_breaks_off_says_how_much_was_readable(tmp_path: Path):
    path = tmp_path / "m.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 20, (320, 240))
    for number in range(40):
        writer.write(picture(number, (320, 240)))
    writer.release()
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    source = open_frame_source(str(path))
    count = len(all_frames(source))
    assert 10 < count < 30
    assert source.notes == (f"{path} breaks off early: {count} of 40 frames could be read.",)


def test_damaged_frames_of_a_video_are_left_out_and_the_others_follow(tmp_path: Path):
    """The first damaged one ended the video: 9 of 40 frames were read."""
    path = tmp_path / "m.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 20, (320, 240))
    for number in range(40):
        writer.write(np.full((240, 320, 3), 6 * number, np.uint8))
    writer.release()
    content = bytearray(path.read_bytes())
    chunks = re.compile(b"00dc").finditer(bytes(content), content.index(b"movi"))
    begins = [chunk.end() + 4 for chunk in chunks]
    damaged = (10, 11, 25)
    for number in damaged:
        size = begins[number + 1] - 8 - begins[number]
        content[begins[number] : begins[number] + size] = bytes(size)
    path.write_bytes(content)
    source = open_frame_source(str(path))
    frames = all_frames(source)
    kept = [number for number in range(40) if number not in damaged]
    assert [round(frame.image.mean() / 6) for frame in frames] == kept
    assert [frame.name for frame in frames] == [f"frame {number + 1}" for number in kept]
    assert source.notes == (f"In {path} 3 frames are damaged and left out.",)


@pytest.mark.parametrize("codec", ["libx264", "mjpeg"])
def test_a_size_that_changes_within_a_video_is_refused(tmp_path: Path, codec: str):
    """OpenCV alone scales the later pictures to the first one's size, and says nothing."""
    both = bytearray()
    for size in ((160, 120), (320, 240)):
        part = io.BytesIO()
        with av.open(part, "w", format="h264" if codec == "libx264" else "mjpeg") as container:
            stream = container.add_stream(codec, rate=20)
            stream.width, stream.height = size
            stream.pix_fmt = "yuv420p" if codec == "libx264" else "yuvj420p"
            for number in range(50):
                image = picture(number, size)
                container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="bgr24")))
            container.mux(stream.encode())
        both += part.getvalue()
        video = tmp_path / f"{size[0]}.{codec}"
        video.write_bytes(part.getvalue())
        assert len(all_frames(Video(video))) == 50
    (tmp_path / "both").write_bytes(both)
    with pytest.raises(SourceError) as caught:
        all_frames(Video(tmp_path / "both"))
    said = str(caught.value)
    assert "to 320 x 240 px" in said and "cut it into videos" in said
    assert 49 <= int(said.rpartition("frame ")[2].partition(";")[0]) <= 65


def test_videos_that_cannot_be_played(tmp_path: Path, capfd: pytest.CaptureFixture[str]):
    path = write_video(tmp_path / "m.mp4")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    told = (
        f"{path} cannot be played: it is no video, or it was cut off before its end was written; "
        "record or copy it again, or convert it to MP4."
    )
    assert sentence(path) == told
    path.write_text("hello")
    assert sentence(path) == told
    assert capfd.readouterr().err == "", "OpenCV and FFmpeg keep their words to themselves"


def test_the_real_video(shared_data: Path):
    source = open_frame_source(str(shared_data / "wpilib-charuco-12x8.mp4"))
    times = [frame.time_s for frame in all_frames(source)]
    assert source.image_size == (1920, 1080) and not source.notes
    np.testing.assert_allclose(times, np.arange(161) / 30, atol=1e-3)
