"""Strangers' text on a terminal: nothing in it is obeyed."""

from __future__ import annotations

import pytest

from venus3d.engine.printable import printable


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("a\x1b[2Jb", "a\\x1b[2Jb"),
        ("\x9b31m\x07\r\x7f", "\\x9b31m\\x07\\r\\x7f"),
        ("a\u202egnp.exe", "a\\u202egnp.exe"),
        ("\udcff", "\\udcff"),
        ("Größe 3\u00a0mm ± 1 ✓ 板\n\tnext", "Größe 3\u00a0mm ± 1 ✓ 板\n\tnext"),
    ],
)
def test_controls_are_written_out_and_all_else_stays(text: str, printed: str) -> None:
    assert printable(text) == printed
    printable(text).encode()  # a surrogate would end the program here
