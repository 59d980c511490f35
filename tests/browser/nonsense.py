"""A plugin for pytest that replaces every text of the pages by the same nonsense.

All labels are then equal: code that recognises one takes all for it. Holes and tags are kept. It
has to come before the pages: `pytest -p tests.browser.nonsense`.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from types import CodeType, ModuleType
from typing import Any

NONSENSE = "Blah"
_KEPT = re.compile(r"(\{[^{}]*\}|<[^>]*>|&\w+;|\s+$|^\s+)")


def nonsense(text: str) -> str:
    """Each piece of the text between holes and tags becomes one word, if it has any letter."""
    pieces = _KEPT.split(text)
    return "".join(
        piece if _KEPT.fullmatch(piece) or not re.search(r"[^\W\d_]", piece) else NONSENSE
        for piece in pieces
    )


class _Translator(ast.NodeTransformer):
    """Takes what is assigned; keys of dicts and types are names, not texts."""

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        if isinstance(node.value, str):
            return ast.copy_location(ast.Constant(nonsense(node.value)), node)
        return node

    def visit_Dict(self, node: ast.Dict) -> ast.AST:
        node.values = [self.visit(value) for value in node.values]
        return node

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST:
        if node.value is not None:
            node.value = self.visit(node.value)
        return node


class _Loader(SourceFileLoader):
    """Never reads or writes a cache: that has the real texts."""

    def get_code(self, fullname: str) -> CodeType:
        tree = ast.parse(self.get_data(self.path), self.path)
        return compile(ast.fix_missing_locations(_Translator().visit(tree)), self.path, "exec")


class _Finder(PathFinder):
    """Of modules of texts."""

    @classmethod
    def find_spec(
        cls, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if not re.fullmatch(r"venus3d\.(scene|render)\..*texts", fullname):
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        loader: Any = spec and spec.loader
        if spec is not None:
            spec.loader = _Loader(loader.name, loader.path)
        return spec


sys.meta_path.insert(0, _Finder)  # type: ignore[arg-type]
