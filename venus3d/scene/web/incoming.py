"""Validates what a browser sends: values, clicks, commands, and its viewpoint. Every message passes
`is_heard` before viser sees it. viser checks little: anybody who opens the websocket could set any
property of a widget, or a camera that breaks later computations in our threads."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields
from typing import Any

import msgspec
import numpy as np
import viser

from venus3d.scene.web.viser_private import messages

Find = Callable[[str], Any]
_FARTHEST = 1e5
"""Largest coordinate, metres, and largest window, pixels."""
_LONGEST_TEXT = 1000
_SHORTEST = 1e-6
"""Shortest vector that has a direction."""


def is_point_of_view(raw: bytes) -> bool:
    """Whether the message is a browser's viewpoint."""
    return _kind_of(raw) is messages.ViewerCameraMessage and is_heard(raw, lambda _: None)


def is_heard(raw: bytes, find: Find) -> bool:
    """Whether a raw websocket message is one that a page accepts.

    Args:
        find: gives the widget of that name that the browser may change, or None.
    """
    kind = _kind_of(raw)
    rule = None if kind is None else _RULES.get(kind)
    if kind is None or rule is None:
        return False
    try:
        content: dict[str, Any] = msgspec.msgpack.decode(raw)
        del content["type"]
        known = {field.name for field in fields(kind)}
        return (
            known.issuperset(content)
            and all(abs(number) <= _FARTHEST for number in _numbers(content.values()))
            and rule(content, find)
        )
    # No browser sends these; a sender of such may try anything.
    except Exception:
        return False


def _kind_of(raw: bytes) -> type[Any] | None:
    try:
        return _KINDS.get(msgspec.msgpack.decode(raw, type=_Tagged).type)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return None


class _Tagged(msgspec.Struct):
    type: str


def _numbers(values: Iterable[Any]) -> Iterator[float]:
    """All numbers in nested lists, NaN included."""
    for value in values:
        if isinstance(value, (list, tuple)):
            yield from _numbers(value)  # pyright: ignore[reportUnknownArgumentType]
        elif isinstance(value, (int, float)):
            yield value


_Rule = Callable[[dict[str, Any], Find], bool]


def _as(kind: type[Any]) -> _Rule:
    """Checks that all fields are present and have their types."""

    def rule(content: dict[str, Any], _: Find) -> bool:
        msgspec.convert(content, kind)  # raises
        return all(len(v) <= _LONGEST_TEXT for v in content.values() if isinstance(v, str))

    return rule


class _View(msgspec.Struct):
    """viser's message with strict numbers: viser also converts strings."""

    wxyz: tuple[float, float, float, float]
    position: tuple[float, float, float]
    look_at: tuple[float, float, float]
    up_direction: tuple[float, float, float]
    fov: float
    near: float
    far: float
    image_width: float
    image_height: float


def _is_view(content: dict[str, Any], _: Find) -> bool:
    view = msgspec.convert(content, _View)  # raises
    ahead = np.subtract(view.look_at, view.position)
    lengths = [float(np.linalg.norm(v)) for v in (view.wxyz, ahead, view.up_direction)]
    return (
        all(length > _SHORTEST for length in lengths)
        and 0 < view.fov < np.pi
        and view.near > 0
        and view.far > 0
        and view.image_width >= 1
        and view.image_height >= 1
    )


def _is_turned(content: dict[str, Any], find: Find) -> bool:
    return (
        _as(messages.TransformControlsUpdateMessage)(content, find)
        and float(np.linalg.norm(content["wxyz"])) > _SHORTEST
    )


def _is_value(content: dict[str, Any], find: Find) -> bool:
    updates: Mapping[str, Any] = content["updates"]
    widget = find(content["uuid"])
    return widget is not None and list(updates) == ["value"] and _can_hold(widget, updates["value"])


def _can_hold(widget: Any, value: Any) -> bool:
    """Whether a person could give this widget this value; False for kinds that no page has."""
    if widget.disabled or not widget.visible:
        return False
    if isinstance(widget, viser.GuiButtonHandle):
        return value is True
    if isinstance(widget, viser.GuiCheckboxHandle):
        return isinstance(value, bool)
    if isinstance(widget, viser.GuiDropdownHandle):
        return isinstance(value, str) and value in widget.options
    # Button rows too: labels may change while a click is on its way, and pages know the old ones.
    if isinstance(widget, viser.GuiTextHandle | viser.GuiButtonGroupHandle):
        return isinstance(value, str) and len(value) <= _LONGEST_TEXT
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if isinstance(widget, viser.GuiNumberHandle):
        return number and bool(abs(value) <= _FARTHEST)  # of NaN, False
    if isinstance(widget, viser.GuiSliderHandle):
        # A browser may round an end that is not a whole number of steps.
        return number and bool(widget.min - widget.step <= value <= widget.max + widget.step)
    return False


_RULES: dict[type[Any], _Rule] = {
    messages.ViewerCameraMessage: _is_view,
    messages.GuiUpdateMessage: _is_value,
    messages.TransformControlsUpdateMessage: _is_turned,
    **{
        kind: _as(kind)
        for kind in (
            messages.CommandTriggerMessage,
            messages.TransformControlsDragStartMessage,
            messages.TransformControlsDragEndMessage,
            messages.SceneNodeClickMessage,
            messages.ScenePointerMessage,
            messages.SceneNodeDragMessage,
            messages.LocalStorageGetItemResponseMessage,
        )
    },
}
_KINDS = {kind.__name__: kind for kind in _RULES}
