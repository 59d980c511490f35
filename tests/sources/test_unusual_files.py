"""Files of every kind: read, left out and said, or refused in one sentence; nothing ends the
process. A file name that is not UTF-8 once ended it, since OpenCV 5 does not survive one."""

from __future__ import annotations

import os
import struct
import sys
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from tests.sources.test_recordings import all_frames, picture, sentence, write_video
from venus3d.sources.folder import Folder
from venus3d.sources.images import shown
from venus3d.sources.open_frame_source import open_frame_source

RAW_NAME = os.fsdecode(b"caf\xe9")
bytes_in_names = pytest.mark.skipif(sys.platform != "linux", reason="names are Unicode elsewhere")


def png_header(width: int, height: int) -> bytes:
    """A PNG file that says how large it is, and has hardly any pixels."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        check = struct.pack(">I", zlib.crc32(kind + content))
        return struct.pack(">I", len(content)) + kind + content + check

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"\0"))


@bytes_in_names
def test_a_name_that_is_not_utf_8_is_read_and_can_be_written(tmp_path: Path):
    folder = tmp_path / RAW_NAME
    folder.mkdir()
    Image.fromarray(picture()[..., ::-1]).save(folder / f"{RAW_NAME}.png")
    write_video(tmp_path / "m.mp4").rename(folder / f"{RAW_NAME}.mp4")
    for spec in (folder, f"{folder}/*.png", folder / f"{RAW_NAME}.png"):
        (frame,) = all_frames(open_frame_source(str(spec)))
        assert frame.name == r"caf\xe9.png"
        np.testing.assert_array_equal(frame.image, picture())
    assert len(all_frames(open_frame_source(str(folder / f"{RAW_NAME}.mp4")))) == 20
    (folder / f"{RAW_NAME}.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    assert r"caf\xe9.png is damaged" in sentence(folder / f"{RAW_NAME}.png")
    assert shown("plain.png") == "plain.png"


@pytest.mark.parametrize("size", [(20_000, 10_000), (65_000, 65_000)])
def test_an_image_that_is_too_large_is_refused_by_its_header(tmp_path: Path, size: tuple[int, int]):
    (tmp_path / "huge.png").write_bytes(png_header(*size))
    told = (
        f"The image {tmp_path}/huge.png has more than 160 megapixels, too many to search; "
        "scale all images down by the same whole number."
    )
    assert sentence(tmp_path) == told
    assert sentence(tmp_path / "huge.png") == told


@pytest.mark.parametrize(
    ("mode", "name"),
    [
        *(("CMYK", "a.jpg"), ("L", "a.jfif"), ("RGB", "a.jpe"), ("P", "a.png"), ("RGBA", "a.png")),
        *(("LA", "a.png"), ("1", "a.png"), ("P", "a.gif"), ("CMYK", "a.tif"), ("RGBA", "a.webp")),
        *(("RGB", "a.bmp"), ("RGB", "a.jp2"), ("L", "a.pgm"), ("RGB", "named-by-nobody")),
    ],
)
def test_every_kind_of_pixels_looks_the_same(tmp_path: Path, mode: str, name: str):
    grey = np.add.outer(np.arange(0, 192, 4), np.arange(64)).astype(np.uint8)
    image = Image.fromarray(np.stack([grey] * 3, axis=-1))
    turned = image.quantize(128) if mode == "P" else image.convert(mode)
    turned.save(tmp_path / name, {"jfif": "JPEG", "jpe": "JPEG"}.get(name[2:]) or kind(name))
    for spec in (tmp_path, f"{tmp_path}/*", tmp_path / name):
        (frame,) = all_frames(open_frame_source(str(spec)))
        assert frame.image_size == (64, 48)
        seen = frame.image.reshape(48, 64, -1).mean(axis=2).ravel()
        assert np.corrcoef(seen, grey.ravel())[0, 1] > (0.4 if mode == "1" else 0.98)


def kind(name: str) -> str | None:
    return None if "." in name else "PNG"


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.tif", "a.webp", "a.gif", "a.bmp", "a.jp2"])
def test_a_truncated_image_is_refused(tmp_path: Path, name: str):
    path = tmp_path / name
    Image.fromarray(picture(0, (640, 480))).save(path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert "breaks off early" in sentence(path) or "is damaged or incomplete" in sentence(path)


def test_what_is_left_out_is_said_whichever_way_the_source_is_named(tmp_path: Path):
    for name in ("1.jpg", "2.jfif", "3.gif"):
        Image.fromarray(picture()).save(tmp_path / name, "GIF" if name == "3.gif" else "JPEG")
    pages = [Image.fromarray(picture(seed)) for seed in range(3)]
    pages[0].save(tmp_path / "4.tif", save_all=True, append_images=pages[1:])
    for name in ("a.heic", "b.DNG"):
        (tmp_path / name).write_bytes(b"II*\0 a thumbnail follows")
    (tmp_path / "c.png").mkdir()
    for source in (
        open_frame_source(str(tmp_path)),
        open_frame_source(f"{tmp_path}/*"),
        Folder(sorted(tmp_path.iterdir())),
    ):
        assert source.notes == (
            "3 files are left out, as they are not read as images (a.heic, b.DNG and c.png); save "
            "those that are as JPEG or PNG files of full size.",
            "Of 4.tif only the first picture is read, and 2 more are left out; save each as a "
            "file of its own.",
        )
        frames = all_frames(source)
        assert [frame.name for frame in frames] == ["1.jpg", "2.jfif", "3.gif", "4.tif"]
    for name in ("1.jpg", "2.jfif", "3.gif", "4.tif"):
        (tmp_path / name).unlink()
    assert sentence(tmp_path).endswith("There is no other image.")
    assert "b.DNG is a kind of picture that is not read" in sentence(tmp_path / "b.DNG")


def test_what_cannot_be_read_is_left_out_and_named_with_its_reason(tmp_path: Path):
    """However it is named; each sentence is still told of a file that is named alone."""
    for number in (1, 5, 20):
        Image.fromarray(picture(number)).save(tmp_path / f"{number}.jpg")
    content = (tmp_path / "5.jpg").read_bytes()
    (tmp_path / "2.jpg").write_text("no picture")
    (tmp_path / "3.jpg").touch()
    (tmp_path / "4.jpg").write_bytes(content[: 2 * len(content) // 3])
    (tmp_path / "6.png").write_bytes(png_header(20_000, 10_000))
    cv2.imwrite(str(tmp_path / "7.tiff"), np.zeros((48, 64), np.float32))
    (tmp_path / "8.jpg").symlink_to(tmp_path / "gone.jpg")
    paths = sorted(tmp_path.iterdir())
    for source in (
        open_frame_source(str(tmp_path)),
        open_frame_source(f"{tmp_path}/*"),
        Folder([*paths, *paths]),
    ):
        frames = all_frames(source)
        assert sorted(frame.name for frame in frames) == ["1.jpg", "20.jpg", "5.jpg"]
        assert isinstance(source, Folder) and (len(source), source.unread) == (3, 6)
        assert source.notes == (
            "6 files cannot be read and are left out: 2.jpg (not an image), 3.jpg (empty), "
            "4.jpg (breaks off early), 6.png (more than 160 megapixels) and 2 more; copy them "
            "again or remove them.",
        )
    for path in (tmp_path / "1.jpg", tmp_path / "5.jpg", tmp_path / "20.jpg"):
        path.unlink()
    assert sentence(tmp_path) == sentence(tmp_path / "2.jpg")


def test_one_unreadable_file_is_named_in_its_own_sentence(tmp_path: Path):
    Image.fromarray(picture()).save(tmp_path / "1.jpg")
    cv2.imwrite(str(tmp_path / "2.tiff"), np.zeros((48, 64), np.float32))
    source = open_frame_source(str(tmp_path))
    assert len(all_frames(source)) == 1
    assert source.notes == (
        "2.tiff (float32 numbers instead of 8 or 16 bit) cannot be read and is left out; copy it "
        "again or remove it.",
    )


def test_a_size_among_unreadable_files_is_still_refused(tmp_path: Path):
    Image.fromarray(picture()).save(tmp_path / "1.png")
    Image.fromarray(picture(1, (32, 32))).save(tmp_path / "2.png")
    (tmp_path / "3.png").touch()
    assert "The images have 2 sizes" in sentence(tmp_path)


def test_links_that_lead_nowhere(tmp_path: Path):
    loop = tmp_path / "loop.png"
    loop.symlink_to(loop)
    gone = tmp_path / "gone.png"
    gone.symlink_to(tmp_path / "nothing.png")
    for path in (loop, gone):
        assert "is a link that leads to no file" in sentence(path)
    assert "cannot be read" in sentence(tmp_path)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may read it")
def test_a_file_that_may_not_be_read(tmp_path: Path):
    Image.fromarray(picture()).save(tmp_path / "a.png")
    (tmp_path / "a.png").chmod(0)
    for spec in (tmp_path, tmp_path / "a.png"):
        assert "may not be read by you" in sentence(spec)


def test_a_file_that_may_not_be_read_is_told_from_a_damaged_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    Image.fromarray(picture()).save(tmp_path / "a.png")
    source = open_frame_source(str(tmp_path))

    def refused(_: Path) -> bytes:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("venus3d.sources.images.read_regular", refused)
    with pytest.raises(Exception, match="may not be read by you"):
        all_frames(source)


def test_orientation_tags_are_mentioned(tmp_path: Path):
    exif = Image.Exif()
    exif[0x0112] = 3
    Image.fromarray(picture()).save(tmp_path / "1.jpg", exif=exif)
    Image.fromarray(picture()).save(tmp_path / "2.jpg")
    (note,) = open_frame_source(str(tmp_path)).notes
    assert note.startswith("1 of 2 images has an orientation tag, which is not applied")


def test_images_turned_by_a_program_have_two_sizes(tmp_path: Path):
    for number, size in enumerate(((64, 48), (64, 48), (48, 64))):
        Image.fromarray(picture(0, size)).save(tmp_path / f"{number}.png")
    assert sentence(tmp_path) == (
        "The images have 2 sizes (2.png: 48 x 64 px; 0.png, 1.png: 64 x 48 px); some were turned "
        "by 90° by a program: turn those back, all by the same quarter."
    )


def test_a_jpeg_s_brightness_alone_is_what_its_colours_have(tmp_path: Path):
    flat = np.full((48, 64, 3), (40, 90, 160), np.uint8)
    cv2.imwrite(str(tmp_path / "a.jpg"), flat)
    source = Folder([tmp_path / "a.jpg"])
    (read,) = source.readers()
    coloured = all_frames(source)[0].image
    grey = read().image
    assert coloured.ndim == 3 and grey.ndim == 2
    assert np.abs(grey.astype(int) - cv2.cvtColor(coloured, cv2.COLOR_BGR2GRAY)).max() <= 2
