"""What is private in pyrender and overridden is still called so: a method with another name would
be left out without a word."""

from __future__ import annotations

import inspect

import pytest

from venus3d.render.offscreen import Offscreen


def test_pyrender_has_all_that_is_overridden(gl: Offscreen) -> None:
    assert gl.backend == "gl"
    from venus3d.render import gl_renderer

    for owner, names in gl_renderer.PRIVATE.items():
        source = inspect.getsource(owner)
        for name in names:
            if f"self.{name}" not in source and not hasattr(owner, name):
                pytest.fail(f"pyrender's {owner.__name__} has no {name} any more")
