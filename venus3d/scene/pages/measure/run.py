"""Runs the measuring page: the source's pictures go to the page until Ctrl-C."""

from __future__ import annotations

from contextlib import ExitStack, closing
from pathlib import Path

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.measurement import MeasuringCamera
from venus3d.engine.errors import SourceError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.scene.pages.measure import terminal_texts
from venus3d.scene.pages.measure.options import MeasureOptions
from venus3d.scene.pages.measure.page import MeasurePage
from venus3d.scene.web.page import announce, announce_page
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Source
from venus3d.sources.interactive import open_interactive
from venus3d.sources.observation_stream import ObservationStream
from venus3d.sources.source_news import tell_of_trouble
from venus3d.storage.formats import camera_in
from venus3d.storage.result_reader import read_result

_RESULT = "result.json"


def run_measure(options: MeasureOptions) -> None:
    """Serve the page until Ctrl-C. Raises `VenusError` for whatever the user can fix."""
    options.check()
    by, board = _known(options)
    note = (
        ""
        if by.covariance is not None or options.camera is None
        else (terminal_texts.UNCERTAIN.format(name=options.camera.name))
    )
    with ExitStack() as stack:
        source = stack.enter_context(closing(_opened(options, board)))
        tell_of_trouble(source)
        if source.image_size != by.camera.image_size:
            (w, h), (other_w, other_h) = by.camera.image_size, source.image_size
            raise SourceError(
                f"The camera was calibrated at {w} x {h} px, and the source gives {other_w} x "
                f"{other_h}; convert the file with venus3d export --size {other_w}x{other_h}."
            )
        page = stack.enter_context(
            closing(MeasurePage(options.host, options.port, by, board, options.language))
        )
        announce_page(terminal_texts.TITLE, page.server, *page.notes, note)
        stream = ObservationStream(
            source,
            BoardTracker(Detector(board)),
            on_picture=lambda _: None,
            reopen=lambda: _opened(options, board),
        )
        page.on_hold = stream.pause
        told = False

        def step() -> None:
            nonlocal told
            seen = stream.take(timeout=0.05)
            if seen is not None:
                page.show(seen)
            if page.is_wrong and not told:
                told = True
                announce(terminal_texts.WRONG.format(name=options.camera or options.source))

        stream.run(step)
        stream.check()


def _known(options: MeasureOptions) -> tuple[MeasuringCamera, Board]:
    """The camera with what its file says of it; the board that is held."""
    board = options.board.board()
    if options.camera is None:
        return MeasuringCamera(PAPER_CAMERA), board
    file = options.camera / _RESULT if options.camera.is_dir() else options.camera
    record = camera_in(options.camera)
    if file.name == _RESULT and Path(file).is_file():
        noise_px = read_result(file).calibration.residual_sigma_px
        return MeasuringCamera(record.camera, record.covariance, noise_px), board
    return MeasuringCamera(record.camera, record.covariance), board


def _opened(options: MeasureOptions, board: Board) -> Source:
    return open_interactive(options.source, board, flip=options.flip)
