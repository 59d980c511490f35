"""The camera's exposure, gain, focus and white balance: shown, set, locked."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import viser

from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.intents import Intent, SetCamera
from venus3d.scene.web import texts as web_texts
from venus3d.scene.web.buttons import ButtonRow
from venus3d.sources.camera_settings import SETTING_NAMES, CameraSetting, SettingName


class CameraPanel:
    """The settings of one server, in a folder that is there if the camera has any. `ask` is called
    on viser's threads."""

    def __init__(self, gui: viser.GuiApi, ask: Callable[[Intent], None]) -> None:
        """Create the folder in the current panel, folded and hidden."""
        self._ask = ask
        self._shown: tuple[CameraSetting, ...] = ()
        self._folder = gui.add_folder(say.CAMERA_FOLDER, expand_by_default=False, visible=False)
        with self._folder:
            self._rows = {name: _Row(gui, name, self._set) for name in SETTING_NAMES}

    def show(self, settings: tuple[CameraSetting, ...]) -> None:
        """Show the settings that there are."""
        if settings == self._shown:
            return
        self._shown = settings
        self._folder.visible = bool(settings)
        by_name = {setting.name: setting for setting in settings}
        for name, row in self._rows.items():
            row.show(by_name.get(name))

    def _set(self, name: SettingName, wanted: str) -> None:
        self._ask(SetCamera(name, wanted))


class _Row:
    """One setting: its value, and who sets it."""

    def __init__(
        self, gui: viser.GuiApi, name: SettingName, ask: Callable[[SettingName, str], None]
    ) -> None:
        title, hint = say.CAMERA_SETTINGS[name]
        self._ask: Callable[[str], None] = partial(ask, name)
        self._title, self._value = title, 0.0
        self._number = gui.add_number(title, 0.0, step=1.0, hint=hint, visible=False)
        self._number.on_update(self._typed)
        self._who = ButtonRow(
            gui,
            say.CAMERA_WHO,
            _labels(True),
            lambda wanted, _: self._ask(wanted),
            hint=say.CAMERA_WHO_HINT,
        )
        self._who.visible = False

    def show(self, setting: CameraSetting | None) -> None:
        """Show it; None: the camera does not have it."""
        self._number.visible = setting is not None
        automatic = None if setting is None else setting.automatic
        self._who.show({} if automatic is None else _labels(automatic))
        if setting is None:
            return
        if setting.range is not None:
            self._number.min, self._number.max, self._number.step = setting.range
            least, greatest, _ = (f"{end:g}" for end in setting.range)
            self._number.label = say.CAMERA_RANGE.format(
                name=self._title, least=least, greatest=greatest
            )
        if setting.value != self._value:
            self._value = self._number.value = setting.value

    def _typed(self, event: viser.GuiEvent[viser.GuiNumberHandle[float]]) -> None:
        if event.client is not None:
            self._value = float(event.target.value)
            self._ask(f"{self._value:g}")


def _labels(automatic: bool) -> dict[str, str]:
    """The buttons' labels by what they ask for; the one that holds is marked."""
    on = "auto" if automatic else "lock"
    labels = {"auto": say.CAMERA_AUTOMATIC, "lock": say.CAMERA_LOCKED}
    marked = partial(web_texts.SWITCHED_ON.format)
    return {what: marked(label=text) if what == on else text for what, text in labels.items()}
