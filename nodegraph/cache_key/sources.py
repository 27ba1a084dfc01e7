"""The source files of modules: a digest of the code in each, and what it imports."""

from __future__ import annotations

import ast
import hashlib
import threading
import warnings
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from nodegraph.gc_pause import gc_paused

ANY = "*"
"""A reference to a module whose name is known only when the code runs."""
PARSER = threading.RLock()
"""Held while a syntax tree is made.

Before Python 3.11.8 and 3.12.2 all threads count the depth of their trees in one place. Where
memory is tidied up in the middle of a tree, another thread may begin one, and the first ends with
a SystemError (python/cpython issue 106905).
"""
_IMPORTERS = {"import_module", "__import__", "spec_from_file_location", "run_path", "run_module"}
_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
_BLOCKS = {"body", "orelse", "finalbody"}
"""Fields of statements that hold statements."""


class ModuleSource(NamedTuple):
    """The content of a module's file, as far as it decides which code is run: data for JSON.

    A reference is ``module:name``, or ``module:`` for all of a module; relative modules begin with
    dots.

    Attributes
    ----------
    digest : str
        Without comments, docstrings and positions.
    imports : sequence of str
        References to all that it imports, inside functions too, but for type checkers.
    names : mapping of name to references
        Names at its top, also those for type checkers, with what they are imported from; an empty
        reference stands for the module itself.
    acts : bool
        Whether an import of it does more than to bind names.
    """

    digest: str
    imports: Sequence[str] = ()
    names: Mapping[str, Sequence[str]] = {}
    acts: bool = False


def digest_of(content: str | bytes) -> str:
    """Return the first 16 hexadecimal digits of a digest."""
    data = content.encode("utf-8", "surrogatepass") if isinstance(content, str) else content
    return hashlib.sha256(data).hexdigest()[:16]


@gc_paused()
def read_source(file: str) -> ModuleSource:
    """Read the source of a module; what is not Python counts by its bytes."""
    content = Path(file).read_bytes()
    try:
        with PARSER, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # they are shown when the module is imported
            tree = ast.parse(content if file.endswith(".py") else b"\0")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ModuleSource(digest_of(content))  # an import of it fails, and so does the step
    names: defaultdict[str, list[str]] = defaultdict(list)
    acts = False
    for statement in tree.body:
        is_definition = isinstance(statement, _DEFINITIONS)
        for part in [statement] if is_definition else ast.walk(statement):
            for name, reference in _bound(part):
                names[name].append(reference)
            acts = acts or (_acts(part) and not _is_idle(statement))
    return ModuleSource(*_code(tree), names, acts)


def _code(tree: ast.AST) -> tuple[str, list[str]]:
    """Return the digest of a tree without what does nothing when it runs, and all its imports."""
    text: list[str] = []
    imports: set[str] = set()
    waiting: list[Any] = [tree]
    while waiting:
        part = waiting.pop()
        kind: type = type(part)
        fields = _fields(kind)
        if fields is None:
            text.append(hex(part) if kind is int else repr(part))  # of any length
            continue
        if kind is ast.Import or kind is ast.ImportFrom:
            imports.update(reference for _, reference in _imported(part))
        elif kind is ast.Call and _last_name(part.func) in _IMPORTERS:
            imports.add(_loaded(part))
        text.append(kind.__name__)
        for name in fields:
            value = getattr(part, name)
            if type(value) is list:
                value = list(_run(value)) if name in _BLOCKS else value
                text.append(str(len(value)))
                waiting += value
            else:
                waiting.append(value)
    return digest_of("\n".join(text)), sorted(imports)


@cache
def _fields(kind: type) -> tuple[str, ...] | None:
    """Return the fields of a node but for those that follow from the others; None for no node."""
    if not issubclass(kind, ast.AST):
        return None
    return tuple(name for name in kind._fields if name not in ("ctx", "type_comment"))


def _run(statements: Iterable[ast.AST]) -> Iterator[ast.AST]:
    """Yield the statements that do something when they run."""
    for statement in statements:
        if isinstance(statement, ast.If) and _last_name(statement.test) == "TYPE_CHECKING":
            yield from _run(statement.orelse)
        elif not _is_idle(statement):
            yield statement


def _is_idle(statement: ast.AST) -> bool:
    """Whether a statement does nothing: a text by itself, such as a docstring, or ``pass``."""
    if isinstance(statement, ast.Expr):
        value = statement.value
        return isinstance(value, ast.Constant) and isinstance(value.value, str)
    return isinstance(statement, ast.Pass)


def _last_name(expression: ast.expr) -> str:
    if isinstance(expression, ast.Name):
        return expression.id
    return expression.attr if isinstance(expression, ast.Attribute) else ""


def _acts(part: ast.AST) -> bool:
    is_item = isinstance(part, (ast.Attribute, ast.Subscript))
    return isinstance(part, (ast.Expr, ast.Delete)) or (
        is_item and isinstance(getattr(part, "ctx", None), ast.Store)
    )


def _bound(part: ast.AST) -> Iterator[tuple[str, str]]:
    """Yield names that code binds, with references to what they are imported from."""
    if isinstance(part, ast.Name):
        if isinstance(part.ctx, ast.Store):
            yield part.id, ""
    elif isinstance(part, _DEFINITIONS):
        yield part.name, ""
    elif isinstance(part, (ast.Import, ast.ImportFrom)):
        yield from _imported(part)


def _imported(statement: ast.Import | ast.ImportFrom) -> Iterator[tuple[str, str]]:
    """Yield the names that an import binds, with references to what they stand for."""
    if isinstance(statement, ast.Import):
        for alias in statement.names:
            top = alias.name.partition(".")[0]
            yield alias.asname or top, f"{alias.name}:"
            if not alias.asname:
                yield top, f"{top}:"
    else:
        module = "." * statement.level + (statement.module or "")
        for alias in statement.names:
            yield alias.asname or alias.name, f"{module}:{alias.name}"


def _loaded(call: ast.Call) -> str:
    """Return a reference to the module that a function is called to import."""
    name = str(getattr(call.args[0], "value", ".")) if call.args else "."
    is_known = _last_name(call.func) in ("import_module", "__import__")
    return f"{name}:" if is_known and not name.startswith(".") else ANY
