"""Options that rest on those of an earlier run: what is given now counts, also where it is the
usual."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass, replace
from operator import attrgetter
from typing import Any, TypeVar, cast, get_type_hints

import tyro

from venus3d.options import Switch

Options = TypeVar("Options")


def given_over(before: Options, command: str, arguments: Sequence[str]) -> Options:
    """The options of a command's `arguments`; those that are not given are those of `before`."""
    # A switch can only be given to be on.
    off = _switched(before, lambda _name, _on: False)
    given = tyro.cli(type(before), prog=f"venus3d {command}", args=arguments, default=off)
    return _switched(given, lambda name, on: on or attrgetter(name)(before))


def gives_board(arguments: Sequence[str]) -> bool:
    """Whether the arguments give an option of the board."""
    return any(one.startswith("--board.") for one in arguments)


def _switched(options: Options, on: Callable[[str, bool], bool]) -> Options:
    """The options with each switch, "flip" or "board.legacy", on or off."""

    def changed(part: Any, prefix: str) -> Any:
        hints = get_type_hints(type(part), include_extras=True)
        new: dict[str, Any] = {}
        for one in fields(part):
            value, name = getattr(part, one.name), prefix + one.name
            if is_dataclass(value):
                new[one.name] = changed(value, f"{name}.")
            elif hints[one.name] == Switch:
                new[one.name] = on(name, value)
        return replace(part, **new)

    return cast(Options, changed(options, ""))
