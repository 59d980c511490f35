"""A camera's settings while it runs: asked for on any thread, set on the one that reads it.

Captures are not safe with several threads, so the reading thread attends to what was asked for
between two pictures, and sets it again whenever it opens the camera.
"""

from __future__ import annotations

import queue
import time
from collections.abc import Callable, Mapping
from dataclasses import replace

from venus3d.engine.errors import SourceError
from venus3d.sources.camera_settings import (
    Adjustable,
    CameraSetting,
    CameraSettings,
    Range,
    SettingName,
    apply_settings,
    present_settings,
    settings_notes,
)

_LOOK_S = 2.0
"""How often values are read that the camera may have changed by itself."""


class CameraControls:
    """The settings of one camera."""

    def __init__(
        self,
        name: str,
        settings: CameraSettings,
        ranges: Callable[[], Mapping[SettingName, Range]] = dict,
    ) -> None:
        """Of the camera called `name`; `settings` are set as it is opened, and `ranges` is asked
        for what its driver allows."""
        self._name = name
        self.settings = settings
        """What is set whenever the camera is opened."""
        self._ask_ranges, self._ranges = ranges, dict[SettingName, Range]()
        self._asked: queue.SimpleQueue[tuple[SettingName, str]] = queue.SimpleQueue()
        self._refused: queue.SimpleQueue[SourceError] = queue.SimpleQueue()
        self._looked_s = 0.0
        self.present: tuple[CameraSetting, ...] = ()
        """Those that the camera has, as they were last."""
        self.notes: tuple[str, ...] = ()
        """Warnings about the camera as it was opened."""

    def ask(self, name: SettingName, wanted: str) -> None:
        """Ask for a number of the driver's, `auto` or `lock`; from any thread."""
        self._asked.put((name, wanted))

    def refusal(self) -> SourceError | None:
        """Why something was not set, once; from one thread."""
        return None if self._refused.empty() else self._refused.get()

    def opened(self, capture: Adjustable) -> None:
        """Set what was set before. Raises `SourceError` for what the camera does not take."""
        self.settings = apply_settings(capture, self.settings, self._name)
        self._ranges = dict(self._ask_ranges())
        self.notes = settings_notes(capture, self._name)
        self._look(capture)

    def attend(self, capture: Adjustable) -> None:
        """Set what was asked for; between two reads, on the reading thread."""
        while not self._asked.empty():
            name, wanted = self._asked.get()
            one = CameraSettings(**{name: wanted})
            try:
                one.check()
                done = apply_settings(capture, one, self._name)
                self.settings = replace(self.settings, **{name: getattr(done, name)})
            except SourceError as error:
                self._refused.put(error)
            self._looked_s = 0.0
        if time.monotonic() - self._looked_s > _LOOK_S:
            self._look(capture)

    def _look(self, capture: Adjustable) -> None:
        self.present, self._looked_s = present_settings(capture, self._ranges), time.monotonic()
