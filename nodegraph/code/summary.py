"""A module's source, read once: which statements make each of its names."""

from __future__ import annotations

import ast
import builtins
import warnings
from collections.abc import Iterable, Iterator

from nodegraph.code.bindings import STAR, bindings, import_targets
from nodegraph.code.parts import WHOLE_MODULE, Part, Summary
from nodegraph.code.references import references
from nodegraph.code.syntax import DEFINITIONS, Marks, dotted, is_idle, is_mark, syntax_digest

_MARKS = {"nodegraph:node": "", "nodegraph.node:node": "", "nodegraph:": ".node"}
_BUILTINS = frozenset(dir(builtins)) - WHOLE_MODULE
_BLOCKS = (ast.stmt, ast.ExceptHandler, ast.match_case)
_CHANGES = (ast.Assign, ast.AugAssign, ast.AnnAssign)


def summarise(source: bytes) -> Summary:
    """Return what a module's source binds, and how.

    Raises
    ------
    SyntaxError, ValueError, RecursionError, MemoryError
        If the source cannot be parsed.
    """
    with warnings.catch_warnings():
        # whoever imports the module has been told of its doubtful escapes
        warnings.simplefilter("ignore")
        tree = ast.parse(source)
    return _Module(tree).summary()


def part_of(statement: ast.stmt, marks: Marks) -> Part:
    """Return a statement's digest, references and lines."""
    decorated = getattr(statement, "decorator_list", [])
    first = min(one.lineno for one in (statement, *decorated))
    return Part(
        syntax_digest(statement, marks),
        references(statement, marks),
        first,
        statement.end_lineno or first,
        isinstance(statement, DEFINITIONS),
    )


class _Module:
    def __init__(self, tree: ast.Module) -> None:
        self._written = tree.body
        self._body = [one for one in _flat(tree.body) if not _is_left_out(one)]
        self._parts: list[Part] = []
        self._names: dict[str, list[int]] = {}
        self._imports: dict[str, list[str]] = {}
        self._statements: list[int] = []
        self._exported = {
            text
            for one in tree.body
            if _is_export_list(one)
            for part in ast.walk(one)
            if isinstance(part, ast.Constant) and isinstance(text := part.value, str)
        }

    def summary(self) -> Summary:
        for one in self._body:
            if isinstance(one, (ast.Import, ast.ImportFrom)):
                self._import(import_targets(one))
        self._marks = frozenset(
            name + _MARKS[target]
            for name, targets in self._imports.items()
            for target in targets
            if target in _MARKS
        )
        for one in self._body:
            if not isinstance(one, (ast.Import, ast.ImportFrom)):
                self._statement(one)
        stars = self._imports.pop(STAR, [])
        return Summary(
            parts=tuple(self._parts if stars else map(self._shortened, self._parts)),
            names={name: tuple(numbers) for name, numbers in self._names.items()},
            imports={name: tuple(targets) for name, targets in self._imports.items()},
            stars=tuple(target.removesuffix(f":{STAR}") for target in stars),
            statements=tuple(self._statements),
            effects=(*self._registered(), *self._imported_for_effect()),
        )

    def _import(self, targets: Iterable[tuple[str, str]]) -> None:
        for name, target in targets:
            self._imports.setdefault(name, []).append(target)

    def _statement(self, one: ast.stmt) -> None:
        bound = bindings([one])
        number = len(self._parts)
        self._parts.append(part_of(one, self._marks.__contains__))
        for name in sorted(bound.names - {STAR, "__all__"}):
            self._names.setdefault(name, []).append(number)
        for name, targets in bound.imports.items():
            self._import((name, target) for target in targets)
        if not bound.names or _acts(one):
            self._statements.append(number)

    def _shortened(self, part: Part) -> Part:
        """Leave out builtins, and attributes of what the module makes itself."""
        kept = []
        for reference in part.references:
            root = reference.partition(".")[0]
            if root in self._imports:
                kept.append(reference)
            elif root in self._names:
                kept.append(root)
            elif root not in _BUILTINS:
                kept.append(reference)
        return part._replace(references=tuple(dict.fromkeys(kept)))

    def _registered(self) -> Iterator[str]:
        """Yield functions that a decorator of this module may enter in a table of this module."""
        for one in self._body:
            if isinstance(one, DEFINITIONS) and any(map(self._registers, one.decorator_list)):
                yield one.name

    def _registers(self, decorator: ast.expr) -> bool:
        function = decorator.func if isinstance(decorator, ast.Call) else decorator
        name, _, attribute = dotted(function).partition(".")
        parts = [self._parts[number] for number in self._names.get(name, ())]
        if attribute:
            return bool(parts)
        taken = {reference for part in parts if part.defines for reference in part.references}
        return any(self._is_variable(reference.partition(".")[0]) for reference in taken)

    def _is_variable(self, name: str) -> bool:
        return any(not self._parts[number].defines for number in self._names.get(name, ()))

    def _imported_for_effect(self) -> Iterator[str]:
        """Yield modules that are imported and never named: they are there for what they do."""
        named = {one.partition(".")[0] for part in self._parts for one in part.references}
        named |= self._exported | self._named_aside()
        for one in self._written:
            if isinstance(one, ast.Import):
                bound = [name for name, _ in import_targets(one)]
                yield from (
                    f"{alias.name}:"
                    for alias, name in zip(one.names, bound, strict=True)
                    if name not in named
                )

    def _named_aside(self) -> set[str]:
        """Return names in what decides nothing: node decorators and what is left out."""
        marks = self._marks.__contains__
        aside: list[ast.AST] = [
            one.test if isinstance(one, ast.If) and _imports_for_types(one) else one
            for one in self._written
            if _is_left_out(one) or (isinstance(one, ast.If) and _imports_for_types(one))
        ]
        for one in self._body:
            if isinstance(one, DEFINITIONS):
                aside += [part for part in one.decorator_list if is_mark(part, marks)]
        return {part.id for one in aside for part in ast.walk(one) if isinstance(part, ast.Name)}


def _flat(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield a module's statements; imports for a type checker stand beside the others."""
    for one in body:
        if isinstance(one, ast.If) and _imports_for_types(one):
            yield from one.body
        else:
            yield one


def _imports_for_types(one: ast.If) -> bool:
    only = all(isinstance(inner, (ast.Import, ast.ImportFrom)) for inner in one.body)
    return only and not one.orelse and dotted(one.test) in ("TYPE_CHECKING", "typing.TYPE_CHECKING")


def _is_left_out(one: ast.stmt) -> bool:
    """Whether a statement decides nothing for who imports the module."""
    future = isinstance(one, ast.ImportFrom) and one.module == "__future__"
    return future or is_idle(one) or _is_export_list(one) or _is_for_scripts(one)


def _is_export_list(one: ast.stmt) -> bool:
    if isinstance(one, ast.Expr) and isinstance(one.value, ast.Call):
        return dotted(one.value.func).startswith("__all__.")
    targets = one.targets if isinstance(one, ast.Assign) else [getattr(one, "target", None)]
    return isinstance(one, _CHANGES) and all(
        isinstance(target, ast.Name) and target.id == "__all__" for target in targets
    )


def _is_for_scripts(one: ast.stmt) -> bool:
    """Whether a statement is ``if __name__ == "__main__"``."""
    if not isinstance(one, ast.If) or one.orelse:
        return False
    return ast.unparse(one.test) == "__name__ == '__main__'"


def _acts(one: ast.stmt) -> bool:
    """Whether a statement does more than to bind names, such as a call in a loop."""
    stack: list[ast.AST] = [one]
    while stack:
        inner = stack.pop()
        if isinstance(inner, ast.Delete) or (isinstance(inner, ast.Expr) and not is_idle(inner)):
            return True
        if isinstance(inner, _CHANGES):
            targets = inner.targets if isinstance(inner, ast.Assign) else [inner.target]
            if any(isinstance(part, (ast.Attribute, ast.Subscript)) for part in targets):
                return True
        elif isinstance(inner, _BLOCKS) and not isinstance(inner, DEFINITIONS):
            stack.extend(ast.iter_child_nodes(inner))
    return False
