"""The source files of modules: a digest of the code in each, and what it imports."""

from __future__ import annotations

import ast
import hashlib
import threading
import warnings
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeGuard

from nodegraph.gc_pause import gc_paused

ANY = "*"
"""A reference to a module whose name is known only when the code runs."""
PARSER = threading.Lock()
"""Held while a source is parsed, or a traceback formatted, which parses its lines: Python 3.11
counts the depth of all threads' trees together, and fails where two of them meet (python/cpython
issue 106905)."""
_IMPORTERS = {"import_module", "__import__", "spec_from_file_location", "run_path", "run_module"}
_IMPORTS = {ast.Import, ast.ImportFrom, ast.Call}
_IDLE = {ast.Expr, ast.Pass}
_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


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
            for name, reference in (*_imported(part), *((name, "") for name in _own_names(part))):
                names[name].append(reference)
        acts = acts or (
            not is_definition and not _is_idle(statement) and any(map(_acts, ast.walk(statement)))
        )
    return ModuleSource(*_code(tree), names, acts)


def _code(tree: ast.AST) -> tuple[str, list[str]]:
    """Return the digest of a tree without what does nothing when it runs, and all its imports."""
    text: list[str] = []
    imports: set[str] = set()
    waiting: list[Any] = [tree]
    while waiting:
        node = waiting.pop()
        kind = type(node)
        if kind is list:
            waiting += (list, *node)  # the class marks the end
        elif not isinstance(node, ast.AST):
            text.append(hex(node) if kind is int else repr(node))  # of any length
        elif kind is ast.If and _is_for_types(node):
            waiting += node.orelse
        elif kind not in _IDLE or not _is_idle(node):
            if kind in _IMPORTS:
                imports.update(reference for _, reference in _imported(node))
            text.append(kind.__name__)
            waiting += [getattr(node, name, None) for name in node._fields]
    return digest_of("\n".join(text)), sorted(imports)


def _is_idle(node: ast.AST) -> bool:
    """Whether a statement does nothing: a text by itself, such as a docstring, or ``pass``."""
    if isinstance(node, ast.Expr):
        return isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
    return isinstance(node, ast.Pass)


def _is_for_types(node: ast.AST) -> TypeGuard[ast.If]:
    return type(node) is ast.If and _last_name(node.test) == "TYPE_CHECKING"


def _last_name(expression: ast.expr) -> str:
    name = getattr(expression, "attr", None) or getattr(expression, "id", "")
    return str(name)


def _acts(part: ast.AST) -> bool:
    is_item = isinstance(part, (ast.Attribute, ast.Subscript))
    return isinstance(part, (ast.Expr, ast.Delete)) or (
        is_item and isinstance(getattr(part, "ctx", None), ast.Store)
    )


def _own_names(part: ast.AST) -> Iterator[str]:
    if isinstance(part, _DEFINITIONS):
        yield part.name
    elif isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store):
        yield part.id


def _imported(node: ast.AST) -> Iterator[tuple[str, str]]:
    """Yield the names that an import binds, with references to what they stand for."""
    if isinstance(node, ast.Import):
        for alias in node.names:
            top = alias.name.partition(".")[0]
            yield alias.asname or top, f"{alias.name}:"
            if not alias.asname:
                yield top, f"{top}:"
    elif isinstance(node, ast.ImportFrom):
        module = "." * node.level + (node.module or "")
        for alias in node.names:
            yield alias.asname or alias.name, f"{module}:{alias.name}"
    elif isinstance(node, ast.Call) and (function := _last_name(node.func)) in _IMPORTERS:
        name = str(getattr(node.args[0], "value", ".")) if node.args else "."
        is_known = function in ("import_module", "__import__") and not name.startswith(".")
        yield "", f"{name}:" if is_known else ANY
