"""A session's or a result's file with any value of another kind ends in a sentence, not in Python's
words: `"board": null` ended in a traceback."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from contextlib import suppress
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from venus3d.engine.errors import VenusError
from venus3d.storage.result_reader import read_result
from venus3d.storage.session_moments import moments_of

WRONG = (None, "x", [], {}, -1, True)


def places(node: Any, deep: int = 2) -> Iterator[tuple[Any, ...]]:
    """The ways to the outer values, of lists to the first."""
    names = list(node) if isinstance(node, dict) else list(range(min(len(node), 1)))
    for name in names:
        yield (name,)
        if deep > 1 and isinstance(node[name], (dict, list)):
            yield from ((name, *rest) for rest in places(node[name], deep - 1))


def damaged(content: Any) -> Iterator[Any]:
    for place in places(content):
        for value in WRONG:
            changed = deepcopy(content)
            node = changed
            for name in place[:-1]:
                node = node[name]
            node[place[-1]] = value
            yield changed


def refused(read: Callable[[], object]) -> bool:
    with suppress(VenusError):
        read()
        return False
    return True


def test_a_damaged_result(kept_session: Path, tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    content = json.loads((kept_session / "result.json").read_text())
    told = 0
    for changed in damaged(content):
        file.write_text(json.dumps(changed))
        told += refused(lambda: read_result(file))
    assert told > 50


@pytest.mark.parametrize("line", [0, 1, -1])
def test_a_damaged_journal(kept_session: Path, tmp_path: Path, line: int) -> None:
    folder = shutil.copytree(kept_session, tmp_path / "session")
    events = [json.loads(one) for one in (folder / "events.jsonl").read_text().splitlines()]
    told = 0
    for changed in damaged(events[line]):
        lines = [*events]
        lines[line] = changed
        (folder / "events.jsonl").write_text("".join(f"{json.dumps(one)}\n" for one in lines))
        told += refused(lambda: moments_of(folder))
    assert told > 10
