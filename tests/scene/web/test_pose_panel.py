"""The six sliders: a number that is edited changes that number, and no other."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from venus3d.engine.geometry.pose import Array
from venus3d.scene.web.pose_panel import PosePanel


class Slider(SimpleNamespace):
    """A slider of viser's, without a browser."""

    def on_update(self, callback: Any) -> None:
        self.callback = callback

    def edit(self, value: float) -> None:
        self.value = value
        self.callback(SimpleNamespace(client=object(), target=self))


class Gui:
    """Makes such sliders."""

    def __init__(self) -> None:
        self.sliders: list[Slider] = []

    def add_slider(
        self, _: str, low: float, high: float, step: float, value: float, **__: Any
    ) -> Slider:
        self.sliders.append(Slider(min=low, max=high, step=step, value=value, disabled=False))
        return self.sliders[-1]


def test_a_number_that_a_slider_cannot_show_stays_when_another_one_is_edited() -> None:
    """A lesson's pose may be beyond the sliders: editing an angle once moved the board as well."""
    gui, came = Gui(), list[Array]()
    panel = PosePanel(gui, came.append, (0, 0, 0, 0, 0, 500))  # type: ignore[arg-type]
    panel.show((10.2, 0, 0, -450, 0, 1500))
    assert [slider.value for slider in gui.sliders] == [10.0, 0, 0, -300, 0, 1200]
    assert not came, "set by the program"
    gui.sliders[1].edit(-25.0)
    np.testing.assert_array_equal(came[-1], [10.2, -25, 0, -450, 0, 1500])
    gui.sliders[3].edit(-290.0)
    np.testing.assert_array_equal(came[-1], [10.2, -25, 0, -290, 0, 1500])
    np.testing.assert_array_equal(panel.vector, came[-1])
