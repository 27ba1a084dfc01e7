"""The written form of a statement that counts: what no cosmetic edit can change."""

from __future__ import annotations

import ast
from collections.abc import Callable
from types import EllipsisType, NoneType
from typing import Any

from nodegraph.code.parts import short_digest

Marks = Callable[[str], bool]
"""Whether a dotted name is the decorator that makes a node: it names and cites, no more."""

FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_LEAVES = {str, int, float, complex, bytes, bool, NoneType, EllipsisType}
DEFINITIONS = (*FUNCTIONS, ast.ClassDef)


def syntax_digest(tree: ast.AST, marks: Marks) -> str:
    """Return a digest of a syntax tree without places, docstrings and node decorators."""
    tokens: list[object] = []
    stack: list[Any] = [tree]
    while stack:
        found = stack.pop()
        kind = type(found)
        if kind is list:
            kept = [one for one in found if not is_idle(one)]
            tokens.append(len(kept))
            stack += kept
        elif kind in _LEAVES:
            tokens.append(found)
        else:
            fields = found.__dict__
            tokens.append(kind.__name__)
            if kind in FUNCTIONS and fields["decorator_list"]:
                fields = fields | {"decorator_list": decorators(found, marks)}
            stack += map(fields.get, kind._fields)
    return short_digest(tokens)


def children(tree: ast.AST) -> list[ast.AST]:
    """Return the nodes directly below one, in any order, three times as fast as `ast` does."""
    found = []
    for value in tree.__dict__.values():
        if type(value) is list:
            found += [one for one in value if isinstance(one, ast.AST)]
        elif isinstance(value, ast.AST) and not isinstance(value, ast.expr_context):
            found.append(value)
    return found


def decorators(definition: ast.AST, marks: Marks) -> list[ast.expr]:
    """Return the decorators of a function or class, but for those that make it a node."""
    return [one for one in definition.decorator_list if not is_mark(one, marks)]  # type: ignore[attr-defined]


def is_mark(decorator: ast.expr, marks: Marks) -> bool:
    """Whether a decorator makes a node."""
    return isinstance(decorator, ast.Call) and marks(dotted(decorator.func))


def is_idle(statement: object) -> bool:
    """Whether a statement does nothing: a text by itself, such as a docstring, or ``pass``."""
    kind = type(statement)
    if kind is ast.Expr:
        value = statement.value  # type: ignore[attr-defined]
        return type(value) is ast.Constant and type(value.value) is str
    return kind is ast.Pass


def dotted(expression: ast.expr) -> str:
    """Return ``a.b.c`` for such an expression, and an empty text for any other."""
    attributes = []
    while isinstance(expression, ast.Attribute):
        attributes.append(expression.attr)
        expression = expression.value
    if not isinstance(expression, ast.Name):
        return ""
    return ".".join([expression.id, *reversed(attributes)])
