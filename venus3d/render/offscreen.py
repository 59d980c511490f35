"""Offscreen pictures of shapes as a camera with a lens would take them. One thread owns OpenGL; any
thread may request pictures. If OpenGL is missing or fails, `Painter` draws the same shapes with
OpenCV. Both use the same lens map."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextvars import copy_context
from dataclasses import replace
from functools import partial
from textwrap import shorten
from typing import Any, Literal, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.camera import Camera
from venus3d.render import texts
from venus3d.render.lens import lens_for
from venus3d.render.painter import Painter
from venus3d.render.shapes import Colour, LabelShape, LineShape, MeshShape, Shape
from venus3d.render.text_drawing import paint_labels

Image = NDArray[np.uint8]
Backend = Literal["gl", "painter"]
_LOG = logging.getLogger(__name__)
_CAUSE_LENGTH = 160


class Renderer(Protocol):
    """Draws meshes and lines through an ideal pinhole."""

    def render(
        self, camera: Camera, shapes: Sequence[MeshShape | LineShape], background: Colour
    ) -> Image:
        """RGBA (H, W, 4); alpha is meaningless."""
        ...

    def close(self) -> None:
        """Release all resources."""
        ...


class Offscreen:
    """The only place that renders pictures. `submit` from any thread; close it when done."""

    def __init__(
        self, backend: Literal["auto", "gl", "painter"] = "auto", *, smooth: bool = True
    ) -> None:
        """Start the render thread. Without `smooth` there is no antialiasing, in half the time: for
        pictures that are blurred anyway. Raises `RuntimeError` if `backend` is "gl" and OpenGL is
        unavailable; with "gl", later failures are raised too instead of being painted."""
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="offscreen")
        self._closed = False
        self.note = ""
        """Why the painter draws, in one sentence; empty while OpenGL does. Late failures are logged
        too."""
        self.backend: Backend = "painter"
        self._falls_back = backend == "auto"
        self._renderer: Renderer = Painter()
        if backend != "painter":
            try:
                self._renderer = self._thread.submit(_open_gl, smooth).result()
                self.backend = "gl"
            except Exception as error:
                # Whatever keeps OpenGL from starting (no library, device or pyrender), pictures are
                # needed.
                if not self._falls_back:
                    self._thread.shutdown()
                    raise RuntimeError(f"OpenGL cannot be used: {error}") from error
                self.note = texts.NO_OPENGL.format(cause=_cause(error))

    def submit(
        self,
        camera: Camera,
        shapes: Sequence[Shape] | Callable[[], Sequence[Shape]],
        *,
        background: Colour | Image = (0, 0, 0),
        size: tuple[int, int] | None = None,
        supersample: int = 1,
        finish: Callable[[Image], Image] | None = None,
    ) -> Future[Image]:
        """Request a picture, RGB (H, W, 3) uint8.

        Args:
            camera: its own lens is applied.
            shapes: those with `in_projection` are drawn; or a function that makes them, called on
            the render thread.
            background: a colour, or an RGB picture of the output's size.
            size: (width, height) of the picture; the camera's own if None.
            supersample: render this many times larger and shrink, for smooth small pictures.
            finish: post-processing, called on the render thread.
        """

        def draw() -> Image:
            seen = tuple(shapes() if callable(shapes) else shapes)
            picture = self._draw(
                partial(_picture, camera, seen, background, size or camera.image_size, supersample)
            )
            return picture if finish is None else finish(picture)

        # The render thread speaks the language of whoever asks.
        return self._thread.submit(copy_context().run, draw)

    def render(self, camera: Camera, shapes: Sequence[Shape], **options: Any) -> Image:
        """`submit` and wait for the picture."""
        return self.submit(camera, shapes, **options).result()

    def close(self) -> None:
        """Finish pending requests and release OpenGL. May be called twice."""
        if not self._closed:
            self._closed = True
            with self._thread:
                self._thread.submit(self._release).result()

    def __enter__(self) -> Offscreen:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _draw(self, picture: Callable[[Renderer], Image]) -> Image:
        try:
            return picture(self._renderer)
        except Exception as error:
            # A lost context, a driver error, too little memory: the picture is still needed.
            if self.backend == "painter" or not self._falls_back:
                raise
            painter = Painter()
            # If this fails as well, the shapes are at fault: raise, and keep OpenGL.
            painted = picture(painter)
            self._release()
            # The note first: who sees the other renderer can say why.
            self.note = texts.OPENGL_FAILED.format(cause=_cause(error))
            self._renderer, self.backend = painter, "painter"
            _LOG.warning("%s", self.note)
            return painted

    def _release(self) -> None:
        try:
            self._renderer.close()
        except Exception:
            # Closing after a failure may fail too; OpenGL is not used again.
            if not self._falls_back:
                raise


def _picture(
    camera: Camera,
    shapes: tuple[Shape, ...],
    background: Colour | Image,
    size: tuple[int, int],
    supersample: int,
    renderer: Renderer,
) -> Image:
    seen = [s for s in shapes if s.in_projection]
    solids = [s for s in seen if isinstance(s, MeshShape | LineShape)]
    labels = [s for s in seen if isinstance(s, LabelShape)]
    larger = camera.scaled((size[0] * supersample, size[1] * supersample))
    lens = lens_for(larger, solids)
    solids = lens.turned(solids)

    def draw(ground: Colour) -> Image:
        picture = renderer.render(lens.ideal, _widened(solids, supersample), ground)
        # Warping four channels is quicker than dropping one first.
        picture = cv2.cvtColor(lens.bend(picture, (*ground, 255)), cv2.COLOR_RGBA2RGB)
        if supersample > 1:
            picture = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
        return np.asarray(picture, dtype=np.uint8)

    if isinstance(background, tuple):
        picture = draw(background)
    else:
        picture = _over(draw((0, 0, 0)), draw((255, 255, 255)), background)
    return paint_labels(picture, labels, camera.scaled(size)) if labels else picture


def _cause(error: Exception) -> str:
    # PyOpenGL's errors take several lines and list every argument.
    return shorten(f"{type(error).__name__}: {error}", _CAUSE_LENGTH, placeholder=" ...")


def _widened(shapes: Sequence[MeshShape | LineShape], factor: int) -> list[MeshShape | LineShape]:
    return [
        replace(s, width_px=s.width_px * factor) if isinstance(s, LineShape) else s for s in shapes
    ]


def _over(on_black: Image, on_white: Image, ground: Image) -> Image:
    """Composed over a picture: where the renderings on black and white differ, it shows through."""
    through = on_white.astype(np.float32) - on_black
    return np.clip(on_black + through * (ground / np.float32(255)) + 0.5, 0, 255).astype(np.uint8)


def _open_gl(smooth: bool) -> Renderer:
    if sys.platform.startswith("linux"):
        os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
        # pyrender imports pyglet, which otherwise looks for an X display.
        os.environ.setdefault("PYGLET_HEADLESS", "true")
    from venus3d.render.gl_renderer import GlRenderer

    return GlRenderer(smooth=smooth)
