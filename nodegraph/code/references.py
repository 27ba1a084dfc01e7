"""The names that a statement takes from its module, and what it imports itself."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from typing import Any

from nodegraph.code.bindings import (
    COMPREHENSIONS,
    Bindings,
    bindings,
    import_targets,
)
from nodegraph.code.syntax import FUNCTIONS, Marks, children, decorators, dotted


class _Scope:
    """A function, a comprehension or a class; the names of a class hide nothing."""

    def __init__(self, outer: _Scope | None, bound: Bindings, *, is_class: bool = False) -> None:
        self.outer = outer
        self.bound = bound
        self.is_class = is_class
        self.used: set[str] = set()


def references(statement: ast.stmt, marks: Marks) -> tuple[str, ...]:
    """Return what a statement refers to, sorted.

    ``name.attribute`` is a name of its module, ``module:name.attribute`` an import of its own.
    What is bound inside of it, arguments and local variables, does not count. Imports at its top,
    outside functions and classes, are left to the module.
    """
    return _Reader(marks).read(statement)


class _Reader:
    def __init__(self, marks: Marks) -> None:
        self._marks = marks
        self._found: set[str] = set()
        self._scopes: list[_Scope] = []
        self._stack: list[tuple[ast.AST, _Scope | None]] = []

    def read(self, statement: ast.stmt) -> tuple[str, ...]:
        self._stack.append((statement, None))
        while self._stack:
            self._visit(*self._stack.pop())
        for scope in self._scopes:
            for name in scope.bound.imports.keys() - scope.used:
                self._found.update(scope.bound.imports[name])
        return tuple(sorted(self._found))

    def _visit(self, one: Any, scope: _Scope | None) -> None:
        kind = type(one)
        if kind is ast.Constant:
            return
        if kind is ast.Name:
            self._name(one, scope)
        elif kind is ast.Attribute:
            self._attribute(one, scope)
        elif kind in FUNCTIONS:
            self._function(one, scope)
        elif kind is ast.Lambda:
            self._push(_defaults(one.args), scope)
            self._push([one.body], self._inner(scope, one.args, [one.body]))
        elif kind is ast.ClassDef:
            self._class(one, scope)
        elif kind in COMPREHENSIONS:
            self._comprehension(one, scope)
        else:
            self._plainly(one, scope)

    def _plainly(self, one: Any, scope: _Scope | None) -> None:
        """Read what opens no scope."""
        if isinstance(one, (ast.Import, ast.ImportFrom)):
            if scope is not None and scope.is_class:
                self._found.update(target for _, target in import_targets(one))
            return
        if isinstance(one, ast.AnnAssign):
            self._push(_quoted(one.annotation), scope)
        elif isinstance(one, ast.Call):
            self._found.update(_named_modules(one))
        self._push(children(one), scope)

    def _push(self, some: Iterable[ast.AST], scope: _Scope | None) -> None:
        self._stack += [(one, scope) for one in some]

    def _name(self, one: ast.Name, scope: _Scope | None) -> None:
        binds = isinstance(one.ctx, ast.Store) and (scope is None or scope.is_class)
        if not binds:
            self._refer(one.id, "", scope)

    def _attribute(self, one: ast.Attribute, scope: _Scope | None) -> None:
        root, _, attributes = dotted(one).partition(".")
        if root:
            self._refer(root, attributes, scope)
        else:
            self._push([one.value], scope)

    def _refer(self, name: str, attributes: str, scope: _Scope | None) -> None:
        while scope is not None and name not in scope.bound.elsewhere:
            if name in scope.bound.names:
                scope.used.add(name)
                targets = scope.bound.imports.get(name, ())
                self._found.update(_joined(target, attributes) for target in targets)
                return
            scope = scope.outer
        self._found.add(f"{name}.{attributes}" if attributes else name)

    def _function(self, one: ast.FunctionDef | ast.AsyncFunctionDef, scope: _Scope | None) -> None:
        self._push([*decorators(one, self._marks), *_defaults(one.args)], scope)
        for argument in _arguments(one.args):
            if argument.annotation:
                self._annotation(argument.annotation, scope)
        if one.returns:
            self._annotation(one.returns, scope)
        parameters = getattr(one, "type_params", [])
        self._push(parameters, scope)
        inner = self._inner(scope, one.args, one.body)
        inner.bound.names.update(parameter.name for parameter in parameters)
        self._push(one.body, inner)

    def _class(self, one: ast.ClassDef, scope: _Scope | None) -> None:
        parameters = getattr(one, "type_params", [])
        self._push([*one.decorator_list, *one.bases, *one.keywords, *parameters], scope)
        self._push(one.body, _Scope(scope, Bindings(), is_class=True))

    def _inner(
        self, scope: _Scope | None, arguments: ast.arguments, body: Iterable[ast.AST]
    ) -> _Scope:
        bound = bindings(body)
        bound.names.update(argument.arg for argument in _arguments(arguments))
        made = _Scope(scope, bound)
        self._scopes.append(made)
        return made

    def _comprehension(
        self,
        one: ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp,
        scope: _Scope | None,
    ) -> None:
        targets = bindings([loop.target for loop in one.generators])
        inner = _Scope(scope, targets)
        # Python evaluates the first iterable outside
        self._push([one.generators[0].iter], scope)
        for loop in one.generators:
            self._push([loop.target, *loop.ifs], inner)
        self._push([loop.iter for loop in one.generators[1:]], inner)
        parts = [part for part in children(one) if type(part) is not ast.comprehension]
        self._push(parts, inner)

    def _annotation(self, annotation: ast.expr, scope: _Scope | None) -> None:
        self._push([annotation, *_quoted(annotation)], scope)


def _joined(target: str, attributes: str) -> str:
    if not attributes:
        return target
    return target + attributes if target.endswith(":") else f"{target}.{attributes}"


def _arguments(arguments: ast.arguments) -> Iterator[ast.arg]:
    yield from (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)
    yield from (one for one in (arguments.vararg, arguments.kwarg) if one)


def _defaults(arguments: ast.arguments) -> list[ast.expr]:
    return [*arguments.defaults, *(one for one in arguments.kw_defaults if one)]


def _named_modules(one: ast.Call) -> Iterator[str]:
    """Yield the module that ``import_module("a.b")`` imports."""
    if one.args and isinstance(one.args[0], ast.Constant):
        name = one.args[0].value
        imports = dotted(one.func).rpartition(".")[2] in ("import_module", "__import__")
        if imports and isinstance(name, str) and not name.startswith("."):
            yield f"{name}:"


def _quoted(annotation: ast.expr) -> Iterator[ast.expr]:
    """Yield the types that an annotation holds as texts; texts that are values are left out."""
    stack: list[ast.AST] = [annotation]
    while stack:
        one = stack.pop()
        if isinstance(one, ast.Constant) and isinstance(one.value, str):
            if parsed := _expression(one.value):
                yield parsed
                stack.append(parsed)
        elif isinstance(one, ast.Subscript):
            stack.extend(_types_in(one))
        elif isinstance(one, (ast.BinOp, ast.Tuple, ast.List, ast.Starred)):
            stack.extend(ast.iter_child_nodes(one))


def _types_in(subscript: ast.Subscript) -> list[ast.expr]:
    name = dotted(subscript.value).rpartition(".")[2]
    if name == "Literal":
        return []
    if name == "Annotated" and isinstance(subscript.slice, ast.Tuple):
        return subscript.slice.elts[:1]
    return [subscript.value, subscript.slice]


def _expression(text: str) -> ast.expr | None:
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
