"""What a block of statements binds in its own scope."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import Any

from nodegraph.code.syntax import DEFINITIONS, children

COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
STAR = "*"
_BINDING = {
    ast.Name, *DEFINITIONS, ast.Import, ast.ImportFrom, ast.Global, ast.Nonlocal,
    ast.ExceptHandler, ast.MatchAs, ast.MatchStar, ast.MatchMapping,
}  # fmt: skip
_CLOSED = {ast.Name, ast.Constant, ast.Lambda, *DEFINITIONS}


class Bindings:
    """Names of one scope.

    Attributes
    ----------
    names : set of str
    imports : dict of name to targets
        Those of the names that an import binds, each with ``module:name`` or ``module:``.
    elsewhere : set of str
        Names that belong to the module, because ``global`` says so.
    """

    def __init__(self) -> None:
        self.names: set[str] = set()
        self.imports: dict[str, list[str]] = {}
        self.elsewhere: set[str] = set()


def bindings(block: Iterable[ast.AST]) -> Bindings:
    """Return what statements bind, without what functions and classes in them bind inside."""
    found = Bindings()
    outer: set[str] = set()
    stack = list(block)
    while stack:
        one = stack.pop()
        kind = type(one)
        if kind in _BINDING:
            _bind(one, found)
            if isinstance(one, ast.Nonlocal):
                outer.update(one.names)
        if kind not in _CLOSED:
            stack += _inside_comprehension(one) if kind in COMPREHENSIONS else children(one)
    found.names -= outer | found.elsewhere
    return found


def import_targets(statement: ast.Import | ast.ImportFrom) -> list[tuple[str, str]]:
    """Return each name that an import binds, with what it stands for."""
    if isinstance(statement, ast.ImportFrom):
        module = "." * statement.level + (statement.module or "")
        return [(one.asname or one.name, f"{module}:{one.name}") for one in statement.names]
    return [
        (one.asname, f"{one.name}:") if one.asname else (_top(one.name), f"{_top(one.name)}:")
        for one in statement.names
    ]


def _bind(one: ast.AST, found: Bindings) -> None:
    if isinstance(one, ast.Name):
        if not isinstance(one.ctx, ast.Load):
            found.names.add(one.id)
    elif isinstance(one, DEFINITIONS):
        found.names.add(one.name)
    elif isinstance(one, (ast.Import, ast.ImportFrom)):
        for name, target in import_targets(one):
            found.names.add(name)
            found.imports.setdefault(name, []).append(target)
    elif isinstance(one, ast.Global):
        found.elsewhere.update(one.names)
    elif isinstance(one, (ast.ExceptHandler, ast.MatchAs, ast.MatchStar)) and one.name:
        found.names.add(one.name)
    elif isinstance(one, ast.MatchMapping) and one.rest:
        found.names.add(one.rest)


def _inside_comprehension(one: Any) -> list[ast.AST]:
    """Return what may bind around a comprehension: its targets are its own, unlike those of :=."""
    loops = [part for loop in one.generators for part in (loop.iter, *loop.ifs)]
    return loops + [part for part in children(one) if type(part) is not ast.comprehension]


def _top(module: str) -> str:
    return module.partition(".")[0]
