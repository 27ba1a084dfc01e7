"""A module's source, read once: which statements make each of its names."""

from __future__ import annotations

import ast
import builtins
import hashlib
import os
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from importlib.machinery import SOURCE_SUFFIXES
from pathlib import Path
from types import EllipsisType, MappingProxyType, NoneType
from typing import Any, NamedTuple

WHOLE_MODULE = frozenset({"eval", "exec", "globals"})
"""With these, code can reach any name of its module."""
PARSER = threading.Lock()
"""Held while a source is parsed: Python 3.11 counts the depth of all threads' trees together, and
fails where two of them meet (python/cpython issue 106905)."""


class Part(NamedTuple):
    """One statement at the top of a module.

    Attributes
    ----------
    digest : str
        Of its syntax, without comments, docstrings and places.
    references : tuple of str
        Names that it takes from its module, with attributes (``np.linalg.norm``), and what it
        imports itself (``package.module:name.attribute``).
    first, last : int
        Its lines, counted from 1, decorators included.
    defines : bool
        Whether it is a function or a class, by itself.
    """

    digest: str
    references: tuple[str, ...]
    first: int
    last: int
    defines: bool = False


class Summary(NamedTuple):
    """The names that a module binds, and the statements that bind them.

    Attributes
    ----------
    parts : tuple of Part
    names : mapping of name to numbers of parts
        Every part that binds or changes the name, in their order.
    imports : mapping of name to targets
        ``module:name``, or ``module:`` for a module itself; relative ones begin with dots.
    stars : tuple of str
        Modules of which every name is imported.
    statements : tuple of int
        Parts that do something when the module is imported, whichever name is used.
    effects : tuple of str
        What else is run when the module is imported, as references.
    trouble : str
        Why the file cannot be read.
    """

    parts: tuple[Part, ...] = ()
    names: Mapping[str, tuple[int, ...]] = MappingProxyType({})
    imports: Mapping[str, tuple[str, ...]] = MappingProxyType({})
    stars: tuple[str, ...] = ()
    statements: tuple[int, ...] = ()
    effects: tuple[str, ...] = ()
    trouble: str = ""


def short_digest(*texts: object) -> str:
    """Return 16 hexadecimal digits for the written form of plain values."""
    return hashlib.sha256(repr(texts).encode("utf-8", "surrogatepass")).hexdigest()[:16]


def to_plain(summary: Summary) -> dict[str, object]:
    """Return a summary as what JSON can hold."""
    return {
        "parts": [
            [part.digest, list(part.references), part.first, part.last, part.defines]
            for part in summary.parts
        ],
        "names": {name: list(numbers) for name, numbers in summary.names.items()},
        "imports": {name: list(targets) for name, targets in summary.imports.items()},
        "stars": list(summary.stars),
        "statements": list(summary.statements),
        "effects": list(summary.effects),
    }


def from_plain(plain: Any) -> Summary:
    """Return the summary again.

    Raises
    ------
    TypeError, ValueError, KeyError
        If it is none.
    """
    parts = tuple(_part(*part) for part in plain["parts"])
    return Summary(
        parts=parts,
        names={name: _numbers(some, len(parts)) for name, some in plain["names"].items()},
        imports={name: _texts(some) for name, some in plain["imports"].items()},
        stars=_texts(plain["stars"]),
        statements=_numbers(plain["statements"], len(parts)),
        effects=_texts(plain["effects"]),
    )


def _part(
    digest: object, references: Iterable[object], first: object, last: object, defines: object
) -> Part:
    if not (isinstance(digest, str) and type(first) is type(last) is int):
        raise TypeError("not a part")
    return Part(digest, _texts(references), first, last, bool(defines))


def _texts(some: Iterable[Any]) -> tuple[str, ...]:
    texts = tuple(some)
    if isinstance(some, str) or not {str}.issuperset(map(type, texts)):
        raise TypeError("not texts")
    return texts


def _numbers(some: Iterable[Any], count: int) -> tuple[int, ...]:
    numbers = tuple(some)
    if not ({int}.issuperset(map(type, numbers)) and set(range(count)).issuperset(numbers)):
        raise ValueError("not numbers of parts")
    return numbers


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
        node = stack.pop()
        kind = type(node)
        if kind is list:
            parts = [child for child in node if not is_idle(child)]
            # marks the end of the list: else two trees could have the same tokens
            tokens.append(len(parts))
            stack += parts
        elif kind in _LEAVES:
            tokens.append(node)
        else:
            fields = node.__dict__
            tokens.append(kind.__name__)
            if kind in FUNCTIONS and fields["decorator_list"]:
                fields = fields | {"decorator_list": decorators(node, marks)}
            stack += map(fields.get, kind._fields)
    return short_digest(tokens)


def children(tree: ast.AST) -> list[ast.AST]:
    """Return the nodes directly below one, in any order, three times as fast as `ast` does."""
    nodes = []
    for value in tree.__dict__.values():
        if type(value) is list:
            nodes += [item for item in value if isinstance(item, ast.AST)]
        elif isinstance(value, ast.AST) and not isinstance(value, ast.expr_context):
            nodes.append(value)
    return nodes


def decorators(definition: ast.AST, marks: Marks) -> list[ast.expr]:
    """Return the decorators of a function or class, but for those that make it a node."""
    return [decorator for decorator in definition.decorator_list if not is_mark(decorator, marks)]  # type: ignore[attr-defined]


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
        Names that belong to the module, because they are declared ``global``.
    """

    def __init__(self) -> None:
        self.names: set[str] = set()
        self.imports: dict[str, list[str]] = {}
        self.elsewhere: set[str] = set()


def bindings(block: Iterable[ast.AST]) -> Bindings:
    """Return the names that statements bind, without those bound inside functions and classes."""
    bound = Bindings()
    outer: set[str] = set()
    stack = list(block)
    while stack:
        node = stack.pop()
        kind = type(node)
        if kind in _BINDING:
            _bind(node, bound)
            if isinstance(node, ast.Nonlocal):
                outer.update(node.names)
        if kind not in _CLOSED:
            stack += _inside_comprehension(node) if kind in COMPREHENSIONS else children(node)
    bound.names -= outer | bound.elsewhere
    return bound


def import_targets(statement: ast.Import | ast.ImportFrom) -> list[tuple[str, str]]:
    """Return each name that an import binds, with what it stands for."""
    if isinstance(statement, ast.ImportFrom):
        module = "." * statement.level + (statement.module or "")
        return [(alias.asname or alias.name, f"{module}:{alias.name}") for alias in statement.names]
    return [
        (alias.asname, f"{alias.name}:")
        if alias.asname
        else (_top(alias.name), f"{_top(alias.name)}:")
        for alias in statement.names
    ]


def _bind(node: ast.AST, bound: Bindings) -> None:
    if isinstance(node, ast.Name):
        if not isinstance(node.ctx, ast.Load):
            bound.names.add(node.id)
    elif isinstance(node, DEFINITIONS):
        bound.names.add(node.name)
    elif isinstance(node, (ast.Import, ast.ImportFrom)):
        for name, target in import_targets(node):
            bound.names.add(name)
            bound.imports.setdefault(name, []).append(target)
    elif isinstance(node, ast.Global):
        bound.elsewhere.update(node.names)
    elif isinstance(node, (ast.ExceptHandler, ast.MatchAs, ast.MatchStar)) and node.name:
        bound.names.add(node.name)
    elif isinstance(node, ast.MatchMapping) and node.rest:
        bound.names.add(node.rest)


def _inside_comprehension(comprehension: Any) -> list[ast.AST]:
    """Return the nodes of a comprehension that may bind names around it, as := does."""
    loops = [part for loop in comprehension.generators for part in (loop.iter, *loop.ifs)]
    return loops + [part for part in children(comprehension) if type(part) is not ast.comprehension]


def _top(module: str) -> str:
    return module.partition(".")[0]


class _Scope:
    """A function, a comprehension or a class; the names of a class hide nothing."""

    def __init__(self, outer: _Scope | None, bound: Bindings, *, is_class: bool = False) -> None:
        self.outer = outer
        self.bound = bound
        self.is_class = is_class
        self.used: set[str] = set()


def references(statement: ast.stmt, marks: Marks) -> tuple[str, ...]:
    """Return the names that a statement refers to, sorted.

    ``name.attribute`` is a name of its module, ``module:name.attribute`` an import of its own.
    What is bound inside of it, arguments and local variables, does not count. Imports at its top,
    outside functions and classes, are left to the module.
    """
    return _Reader(marks).read(statement)


class _Reader:
    def __init__(self, marks: Marks) -> None:
        self._marks = marks
        self._names: set[str] = set()
        self._scopes: list[_Scope] = []
        self._stack: list[tuple[ast.AST, _Scope | None]] = []

    def read(self, statement: ast.stmt) -> tuple[str, ...]:
        self._stack.append((statement, None))
        while self._stack:
            self._visit(*self._stack.pop())
        for scope in self._scopes:
            for name in scope.bound.imports.keys() - scope.used:
                self._names.update(scope.bound.imports[name])
        return tuple(sorted(self._names))

    def _visit(self, node: Any, scope: _Scope | None) -> None:
        kind = type(node)
        if kind is ast.Constant:
            return
        if kind is ast.Name:
            self._name(node, scope)
        elif kind is ast.Attribute:
            self._attribute(node, scope)
        elif kind in FUNCTIONS:
            self._function(node, scope)
        elif kind is ast.Lambda:
            self._push(_defaults(node.args), scope)
            self._push([node.body], self._inner(scope, node.args, [node.body]))
        elif kind is ast.ClassDef:
            self._class(node, scope)
        elif kind in COMPREHENSIONS:
            self._comprehension(node, scope)
        else:
            self._plainly(node, scope)

    def _plainly(self, node: Any, scope: _Scope | None) -> None:
        """Read what opens no scope."""
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            if scope is not None and scope.is_class:
                self._names.update(target for _, target in import_targets(node))
            return
        if isinstance(node, ast.AnnAssign):
            self._push(_quoted(node.annotation), scope)
        elif isinstance(node, ast.Call):
            self._names.update(_named_modules(node))
        self._push(children(node), scope)

    def _push(self, some: Iterable[ast.AST], scope: _Scope | None) -> None:
        self._stack += [(node, scope) for node in some]

    def _name(self, name: ast.Name, scope: _Scope | None) -> None:
        binds = isinstance(name.ctx, ast.Store) and (scope is None or scope.is_class)
        if not binds:
            self._refer(name.id, "", scope)

    def _attribute(self, attribute: ast.Attribute, scope: _Scope | None) -> None:
        root, _, attributes = dotted(attribute).partition(".")
        if root:
            self._refer(root, attributes, scope)
        else:
            self._push([attribute.value], scope)

    def _refer(self, name: str, attributes: str, scope: _Scope | None) -> None:
        while scope is not None and name not in scope.bound.elsewhere:
            if name in scope.bound.names:
                scope.used.add(name)
                targets = scope.bound.imports.get(name, ())
                self._names.update(_joined(target, attributes) for target in targets)
                return
            scope = scope.outer
        self._names.add(f"{name}.{attributes}" if attributes else name)

    def _function(
        self, function: ast.FunctionDef | ast.AsyncFunctionDef, scope: _Scope | None
    ) -> None:
        self._push([*decorators(function, self._marks), *_defaults(function.args)], scope)
        for argument in _arguments(function.args):
            if argument.annotation:
                self._annotation(argument.annotation, scope)
        if function.returns:
            self._annotation(function.returns, scope)
        parameters = getattr(function, "type_params", [])
        self._push(parameters, scope)
        inner = self._inner(scope, function.args, function.body)
        inner.bound.names.update(parameter.name for parameter in parameters)
        self._push(function.body, inner)

    def _class(self, definition: ast.ClassDef, scope: _Scope | None) -> None:
        parameters = getattr(definition, "type_params", [])
        self._push(
            [*definition.decorator_list, *definition.bases, *definition.keywords, *parameters],
            scope,
        )
        self._push(definition.body, _Scope(scope, Bindings(), is_class=True))

    def _inner(
        self, scope: _Scope | None, arguments: ast.arguments, body: Iterable[ast.AST]
    ) -> _Scope:
        bound = bindings(body)
        bound.names.update(argument.arg for argument in _arguments(arguments))
        inner = _Scope(scope, bound)
        self._scopes.append(inner)
        return inner

    def _comprehension(
        self,
        comprehension: ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp,
        scope: _Scope | None,
    ) -> None:
        targets = bindings([loop.target for loop in comprehension.generators])
        inner = _Scope(scope, targets)
        # Python evaluates the first iterable outside
        self._push([comprehension.generators[0].iter], scope)
        for loop in comprehension.generators:
            self._push([loop.target, *loop.ifs], inner)
        self._push([loop.iter for loop in comprehension.generators[1:]], inner)
        parts = [part for part in children(comprehension) if type(part) is not ast.comprehension]
        self._push(parts, inner)

    def _annotation(self, annotation: ast.expr, scope: _Scope | None) -> None:
        self._push([annotation, *_quoted(annotation)], scope)


def _joined(target: str, attributes: str) -> str:
    if not attributes:
        return target
    return target + attributes if target.endswith(":") else f"{target}.{attributes}"


def _arguments(arguments: ast.arguments) -> Iterator[ast.arg]:
    yield from (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)
    yield from (argument for argument in (arguments.vararg, arguments.kwarg) if argument)


def _defaults(arguments: ast.arguments) -> list[ast.expr]:
    return [*arguments.defaults, *(default for default in arguments.kw_defaults if default)]


def _named_modules(call: ast.Call) -> Iterator[str]:
    """Yield the module that ``import_module("a.b")`` imports."""
    if call.args and isinstance(call.args[0], ast.Constant):
        name = call.args[0].value
        imports = dotted(call.func).rpartition(".")[2] in ("import_module", "__import__")
        if imports and isinstance(name, str) and not name.startswith("."):
            yield f"{name}:"


def _quoted(annotation: ast.expr) -> Iterator[ast.expr]:
    """Yield the types that an annotation holds as texts; texts that are values are left out."""
    stack: list[ast.AST] = [annotation]
    while stack:
        node = stack.pop()
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            if parsed := _expression(node.value):
                yield parsed
                stack.append(parsed)
        elif isinstance(node, ast.Subscript):
            stack.extend(_types_in(node))
        elif isinstance(node, (ast.BinOp, ast.Tuple, ast.List, ast.Starred)):
            stack.extend(ast.iter_child_nodes(node))


def _types_in(subscript: ast.Subscript) -> list[ast.expr]:
    name = dotted(subscript.value).rpartition(".")[2]
    if name == "Literal":
        return []
    if name == "Annotated" and isinstance(subscript.slice, ast.Tuple):
        return subscript.slice.elts[:1]
    return [subscript.value, subscript.slice]


def _expression(text: str) -> ast.expr | None:
    try:
        with PARSER:
            return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None


_MARKS = {"nodegraph:node": "", "nodegraph.node.decorator:node": "", "nodegraph:": ".node"}
_BUILTINS = frozenset(dir(builtins)) - WHOLE_MODULE
_BLOCKS = (ast.stmt, ast.ExceptHandler, ast.match_case)
_CHANGES = (ast.Assign, ast.AugAssign, ast.AnnAssign)


def summarise(source: bytes) -> Summary:
    """Return the names that a module's source binds, and the statements that bind them.

    Raises
    ------
    SyntaxError, ValueError, RecursionError, MemoryError
        If the source cannot be parsed.
    """
    with warnings.catch_warnings():
        # the doubtful escapes were reported when the module was imported
        warnings.simplefilter("ignore")
        with PARSER:
            tree = ast.parse(source)
    return _Module(tree).summary()


def part_of(statement: ast.stmt, marks: Marks) -> Part:
    """Return a statement's digest, references and lines."""
    decorated = getattr(statement, "decorator_list", [])
    first = min(each.lineno for each in (statement, *decorated))
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
        self._body = [statement for statement in _flat(tree.body) if not _is_left_out(statement)]
        self._parts: list[Part] = []
        self._names: dict[str, list[int]] = {}
        self._imports: dict[str, list[str]] = {}
        self._statements: list[int] = []
        self._exported = {
            text
            for statement in tree.body
            if _is_export_list(statement)
            for part in ast.walk(statement)
            if isinstance(part, ast.Constant) and isinstance(text := part.value, str)
        }

    def summary(self) -> Summary:
        for statement in self._body:
            if isinstance(statement, (ast.Import, ast.ImportFrom)):
                self._import(import_targets(statement))
        self._marks = frozenset(
            name + _MARKS[target]
            for name, targets in self._imports.items()
            for target in targets
            if target in _MARKS
        )
        for statement in self._body:
            if not isinstance(statement, (ast.Import, ast.ImportFrom)):
                self._statement(statement)
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

    def _statement(self, statement: ast.stmt) -> None:
        bound = bindings([statement])
        number = len(self._parts)
        self._parts.append(part_of(statement, self._marks.__contains__))
        for name in sorted(bound.names - {STAR, "__all__"}):
            self._names.setdefault(name, []).append(number)
        for name, targets in bound.imports.items():
            self._import((name, target) for target in targets)
        if not bound.names or _acts(statement):
            self._statements.append(number)

    def _shortened(self, part: Part) -> Part:
        """Leave out builtins, and attributes of what the module makes itself."""
        shortened = []
        for reference in part.references:
            root = reference.partition(".")[0]
            if root in self._imports:
                shortened.append(reference)
            elif root in self._names:
                shortened.append(root)
            elif root not in _BUILTINS:
                shortened.append(reference)
        return part._replace(references=tuple(dict.fromkeys(shortened)))

    def _registered(self) -> Iterator[str]:
        """Yield functions that a decorator of this module may enter in a table of this module."""
        for statement in self._body:
            if isinstance(statement, DEFINITIONS) and any(
                map(self._registers, statement.decorator_list)
            ):
                yield statement.name

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
        named = {
            reference.partition(".")[0] for part in self._parts for reference in part.references
        }
        named |= self._exported | self._named_aside()
        for statement in self._written:
            if isinstance(statement, ast.Import):
                bound = [name for name, _ in import_targets(statement)]
                yield from (
                    f"{alias.name}:"
                    for alias, name in zip(statement.names, bound, strict=True)
                    if name not in named
                )

    def _named_aside(self) -> set[str]:
        """Return names in what decides nothing: node decorators and what is left out."""
        marks = self._marks.__contains__
        aside: list[ast.AST] = [
            each.test if isinstance(each, ast.If) and _imports_for_types(each) else each
            for each in self._written
            if _is_left_out(each) or (isinstance(each, ast.If) and _imports_for_types(each))
        ]
        for statement in self._body:
            if isinstance(statement, DEFINITIONS):
                aside += [part for part in statement.decorator_list if is_mark(part, marks)]
        return {part.id for each in aside for part in ast.walk(each) if isinstance(part, ast.Name)}


def _flat(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield a module's statements; those of imports for a type checker included."""
    for statement in body:
        if isinstance(statement, ast.If) and _imports_for_types(statement):
            yield from statement.body
        else:
            yield statement


def _imports_for_types(statement: ast.If) -> bool:
    only = all(isinstance(inner, (ast.Import, ast.ImportFrom)) for inner in statement.body)
    return (
        only
        and not statement.orelse
        and dotted(statement.test) in ("TYPE_CHECKING", "typing.TYPE_CHECKING")
    )


def _is_left_out(statement: ast.stmt) -> bool:
    """Whether a statement decides nothing for who imports the module."""
    future = isinstance(statement, ast.ImportFrom) and statement.module == "__future__"
    return future or is_idle(statement) or _is_export_list(statement) or _is_for_scripts(statement)


def _is_export_list(statement: ast.stmt) -> bool:
    if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
        return dotted(statement.value.func).startswith("__all__.")
    targets = (
        statement.targets
        if isinstance(statement, ast.Assign)
        else [getattr(statement, "target", None)]
    )
    return isinstance(statement, _CHANGES) and all(
        isinstance(target, ast.Name) and target.id == "__all__" for target in targets
    )


def _is_for_scripts(statement: ast.stmt) -> bool:
    """Whether a statement is ``if __name__ == "__main__"``."""
    if not isinstance(statement, ast.If) or statement.orelse:
        return False
    return ast.unparse(statement.test) == "__name__ == '__main__'"


def _acts(statement: ast.stmt) -> bool:
    """Whether a statement does more than to bind names, such as a call in a loop."""
    stack: list[ast.AST] = [statement]
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


SETTLED = 2_000_000_000
"""Nanoseconds after which an edit gets another time, on any file system."""


class Sources:
    """Reads source files.

    Parameters
    ----------
    remembered
        What `remembered` returned in an earlier process. What is not of that form is left out.
    """

    def __init__(self, remembered: object = None) -> None:
        self._known = dict(remembered) if isinstance(remembered, Mapping) else {}
        self._read: dict[str, Summary] = {}

    def summary(self, file: str) -> Summary:
        """Return a file's summary, read once in the life of this object.

        A file without Python source counts as one statement. If the file cannot be read, the
        summary is empty, and says why.
        """
        if file not in self._read:
            self._read[file] = self._summary(file)
        return self._read[file]

    def remembered(self) -> dict[str, object]:
        """Return all summaries by file, for a later process."""
        return self._known

    def _summary(self, file: str) -> Summary:
        # before the file is looked at, so that an edit while it is read counts as a later one
        now = time.time_ns()
        try:
            state = os.stat(file)
            known = _still_true(self._known.get(file), state)
            if known is not None:
                return known
            summary = _read(Path(file))
        except OSError as error:
            self._known.pop(file, None)
            return Summary(trouble=f"its file cannot be read: {error.strerror or error}")
        except SyntaxError as error:
            self._known.pop(file, None)
            return Summary(trouble=f"line {error.lineno or 0} is not Python: {error.msg}")
        except (ValueError, RecursionError, MemoryError) as error:
            self._known.pop(file, None)
            return Summary(trouble=f"its file is not Python that can be read: {error}")
        self._known[file] = {
            "size": state.st_size,
            "mtime_ns": state.st_mtime_ns,
            "read_ns": now,
            "summary": to_plain(summary),
        }
        return summary


def is_source(file: str) -> bool:
    """Whether a file holds Python source."""
    return file.endswith(tuple(SOURCE_SUFFIXES))


def _still_true(entry: Any, state: os.stat_result) -> Summary | None:
    try:
        same = (entry["size"], entry["mtime_ns"]) == (state.st_size, state.st_mtime_ns)
        # what was read right after a change may have changed again without another time
        if same and entry["mtime_ns"] + SETTLED <= entry["read_ns"]:
            return from_plain(entry["summary"])
    except (TypeError, KeyError, ValueError, AttributeError):
        pass  # not of our making: read again
    return None


def _read(path: Path) -> Summary:
    if not is_source(path.name):
        with path.open("rb") as opened:
            digest = hashlib.file_digest(opened, "sha256").hexdigest()
        return Summary(parts=(Part(digest, (), 0, 0),), statements=(0,))
    # late: most files are remembered

    return summarise(path.read_bytes())
