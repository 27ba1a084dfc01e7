"""The modules that code imports, directly or not: found and read without importing them."""

from __future__ import annotations

import ast
import hashlib
import os
import sys
import sysconfig
import threading
import warnings
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property, lru_cache
from importlib import metadata
from importlib.machinery import PathFinder
from importlib.util import find_spec, resolve_name
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from nodegraph.cache_key.files import FileMemo

UNKNOWN = "unknown"
"""The version of a distribution that is not installed."""
_NOT_FOLLOWED = {"nodegraph.plugin.registry", "nodegraph.execute.call"}
"""Modules that find and call nodes, whichever these are; all of nodegraph hangs on them."""
_INSTALLED = {"site-packages", "dist-packages"}
_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
_ANY = "*"
"""A reference to a module whose name is known only when the code runs."""
PARSER = threading.Lock()
"""Held while a source is parsed, or a traceback formatted, which parses its lines: Python 3.11
counts the depth of all threads' trees together, and fails where two of them meet (python/cpython
issue 106905)."""


class Source(NamedTuple):
    """The content of a module's file, as far as it decides which code is run.

    A reference is ``module:name``, or ``module:`` for all of a module; relative modules begin with
    dots.

    Attributes
    ----------
    digest : str
        Without comments, docstrings and positions.
    uses : sequence of str
        References to all that it imports, inside functions too, but for type checkers.
    bound : mapping of name to references
        Names at its top, also those for type checkers, with what they are imported from; an empty
        reference stands for the module itself.
    acts : bool
        Whether an import of it does more than to bind names.
    """

    digest: str
    uses: Sequence[str] = ()
    bound: Mapping[str, Sequence[str]] = MappingProxyType({})
    acts: bool = False

    def modules(self) -> Iterator[str]:
        """Yield references to whole modules that it imports at its top."""
        return (each for taken in self.bound.values() for each in taken if each.endswith(":"))


def digest_of(content: str | bytes) -> str:
    """Return the first 16 hexadecimal digits of a digest."""
    data = content.encode("utf-8", "surrogatepass") if isinstance(content, str) else content
    return hashlib.sha256(data).hexdigest()[:16]


def read_source(file: str) -> Source:
    """Read the source of a module; what is not Python counts by its bytes."""
    content = Path(file).read_bytes()
    try:
        with PARSER, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # they are shown when the module is imported
            tree = ast.parse(content if file.endswith(".py") else b"\0")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return Source(digest_of(content))  # an import of it fails, and so does the step
    nodes = list(ast.walk(tree))
    for node in nodes:
        if isinstance(body := getattr(node, "body", None), list):
            body[:] = [part for part in body if not _is_idle(part)]
    for_types = {id(part) for each in tree.body if _is_for_types(each) for part in ast.walk(each)}
    bound: defaultdict[str, list[str]] = defaultdict(list)
    acts = False
    for statement in tree.body:
        is_definition = isinstance(statement, _DEFINITIONS)
        for part in [statement] if is_definition else ast.walk(statement):
            for name, reference in (*_imports(part), *((name, "") for name in _own_names(part))):
                bound[name].append(reference)
        acts = acts or (not is_definition and any(map(_acts, ast.walk(statement))))
    return Source(
        _tree_digest(tree) or digest_of(content),
        _uses([node for node in nodes if id(node) not in for_types]),
        bound,
        acts,
    )


def _tree_digest(tree: ast.AST) -> str:
    try:
        return digest_of(ast.dump(tree))
    except RecursionError:
        return ""


def _is_idle(statement: ast.AST) -> bool:
    """Whether a statement does nothing: a text by itself, such as a docstring, or ``pass``."""
    if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
        return isinstance(statement.value.value, str)
    return isinstance(statement, ast.Pass)


def _is_for_types(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.If) and _last_name(statement.test) == "TYPE_CHECKING"


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


def _imports(node: ast.AST) -> Iterator[tuple[str, str]]:
    """Yield the names that an import binds, with references to what they stand for."""
    if isinstance(node, ast.Import):
        for alias in node.names:
            top = alias.name.partition(".")[0]
            if alias.asname or top == alias.name:
                yield alias.asname or top, f"{alias.name}:"
            else:
                yield from ((top, f"{top}:"), ("", f"{alias.name}:"))
    elif isinstance(node, ast.ImportFrom):
        module = "." * node.level + (node.module or "")
        yield from ((alias.asname or alias.name, f"{module}:{alias.name}") for alias in node.names)
    elif isinstance(node, ast.Call):
        function = _last_name(node.func)
        if function in ("import_module", "__import__"):
            name = getattr(node.args[0], "value", None) if node.args else None
            is_full = isinstance(name, str) and not name.startswith(".")
            yield "", f"{name}:" if is_full else _ANY
        elif function in ("spec_from_file_location", "run_path", "run_module"):
            yield "", _ANY


def _uses(nodes: Iterable[ast.AST]) -> list[str]:
    """Return references to all imports; to single names of modules that are used in no other way.

    The nodes are in the order of `ast.walk`: an attribute comes before the name that has it.
    """
    attributes: defaultdict[str, set[str]] = defaultdict(set)
    with_attribute: set[int] = set()
    imports: list[tuple[str, str]] = []
    for node in nodes:
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            attributes[node.value.id].add(node.attr)
            with_attribute.add(id(node.value))
        elif isinstance(node, ast.Name) and id(node) not in with_attribute:
            attributes[node.id].add("")
        else:
            imports.extend(_imports(node))
    return sorted(
        {
            f"{reference}{attribute if reference.endswith(':') else ''}"
            for name, reference in imports
            for attribute in attributes.get(name, {""})
        }
    )


class Place(NamedTuple):
    """The file of a module, if it has one, and the folders of its submodules, if it has some."""

    file: str
    folders: tuple[str, ...] = ()


At = tuple[str, str | None]
"""A module and the name that is used of it; an empty name for all of it, None for its import."""


@dataclass
class Reach:
    """The code that references lead to.

    Attributes
    ----------
    digests : dict of module to digest
        Of the modules whose code counts.
    files : dict of module to path
        Of all that decides which modules these are.
    versions : dict of distribution to version
        Of all others.
    troubles : list of str
        Why digests do not tell which code is run.
    """

    digests: dict[str, str] = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    troubles: list[str] = field(default_factory=list)

    def add(self, other: Reach) -> None:
        """Add what another one has."""
        self.digests |= other.digests
        self.files |= other.files
        self.versions |= other.versions
        self.troubles += other.troubles


class Modules:
    """Finds modules by name, and the modules that they import.

    Parameters
    ----------
    followed
        Top-level modules whose code counts wherever they lie, with all that their distributions
        install. So does the code of modules that were not installed. Of every other module the
        version counts.
    memo
        Of sources.
    distributions
        Of each top-level module, as found in an earlier process.
    """

    def __init__(
        self, followed: Iterable[str], memo: FileMemo, distributions: Mapping[str, list[str]]
    ) -> None:
        self.distributions = dict(distributions)
        self._followed = frozenset(followed)
        self._memo = memo
        self._places: dict[str, Place | None] = {}
        self._versions: dict[str, Mapping[str, str] | None] = {}
        self._known: dict[At, tuple[Reach, list[At]]] = {}

    def add(self, file: str, name: str) -> str:
        """Make a file known as a module of that name, and return the name that it has here."""
        place = self._place(name)
        while place is not None and os.path.abspath(place.file) != file:
            name += "'"
            place = self._place(name)
        self._places[name] = place or Place(file)
        return name

    def reach(self, references: Iterable[str]) -> Reach:
        """Return the code that references lead to, directly or not.

        A name that a package imports leads to the module that it is imported from, and not to what
        else the package imports, unless an import of the package does more than to bind names.
        """
        result = Reach()
        waiting = list(_absolute("", references))
        seen: set[At] = set()
        while waiting:
            at = waiting.pop()
            if at not in seen:
                seen.add(at)
                if at not in self._known:
                    own = Reach()
                    self._known[at] = own, list(self._follow(*at, own))
                own, more = self._known[at]
                result.add(own)
                waiting.extend(more)
        return result

    def _follow(self, module: str, name: str | None, own: Reach) -> Iterator[At]:
        """Add a module, and yield all that it leads to."""
        versions = self._counted(module)
        own.versions |= versions or {}
        place = self._place(module)
        if versions is not None or module in _NOT_FOLLOWED or place is None:
            return
        parent = module.rpartition(".")[0]
        if parent:
            yield parent, None
        source = Source("")
        if place.file:
            own.files[module] = place.file
            try:
                source = Source(*self._memo.get(place.file, read_source))
            except OSError as error:
                own.troubles.append(f"{module}: its file cannot be read: {error.strerror or error}")
        package = module if place.folders else parent
        if place.folders and name != "" and not source.acts:
            passed = list(self._passed(module, name, source)) if name else []
            if passed or name is None:
                yield from _absolute(package, source.modules())
                yield from passed
                return
        if place.file:
            own.digests[module] = source.digest
        yield from _absolute(package, source.uses)
        if _ANY in source.uses:
            yield from self._all(module, own)

    def _passed(self, package: str, name: str, source: Source) -> Iterator[At]:
        """Yield where a package takes a name from; nothing if it may be of the package itself."""
        references = source.bound.get(name, [])
        if "" in references:
            return
        yield from _absolute(package, references)
        yield from ((module, name) for module, _ in _absolute(package, source.bound.get("*", [])))
        if self._place(f"{package}.{name}"):
            yield f"{package}.{name}", ""

    def _all(self, module: str, own: Reach) -> Iterator[At]:
        """Yield all modules of a package of which a module imports others by computed names."""
        top = module.partition(".")[0]
        place = self._place(top)
        folders = place.folders if place else ()
        if not folders:
            own.troubles.append(f"{module} imports a module whose name is known only when it runs")
        for folder in map(Path, folders):
            for file in sorted(folder.rglob("*.py")):
                names = (top, *file.relative_to(folder).with_suffix("").parts)
                yield ".".join(names).removesuffix(".__init__"), ""

    def _place(self, name: str) -> Place | None:
        if name not in self._places:
            self._places[name] = self._find(name)
        return self._places[name]

    def _find(self, name: str) -> Place | None:
        module = sys.modules.get(name)
        if module is not None:
            names = vars(module)  # its own `__getattr__` may return anything
            return Place(names.get("__file__") or "", tuple(names.get("__path__", ())))
        parent = name.rpartition(".")[0]
        above = self._place(parent) if parent else None
        if parent and above is None:
            return None
        last = name.rpartition(".")[2]
        spec = PathFinder.find_spec(last, above.folders) if above else find_spec(name)
        if spec is None:
            return None
        file = spec.origin if spec.has_location else ""
        return Place(file or "", tuple(spec.submodule_search_locations or ()))

    def _counted(self, module: str) -> Mapping[str, str] | None:
        """Return the versions that stand for a module's code, or None if the code counts."""
        top = module.partition(".")[0]
        if top not in self._versions:
            self._versions[top] = None if top in self._followed else self._judge(top)
        return self._versions[top]

    def _judge(self, top: str) -> Mapping[str, str] | None:
        place = self._place(top)
        if place is None:
            return {top: UNKNOWN}
        where = place.file or next(iter(place.folders), "")
        if not _INSTALLED.intersection(Path(where).parts):
            return {} if not where or where.startswith(_pythons_folders()) else None
        owners = self._owners(top)
        return None if not owners or self._with_plugins.intersection(owners) else owners

    @cached_property
    def _with_plugins(self) -> frozenset[str]:
        """The distributions of what is followed."""
        return frozenset(owner for top in self._followed for owner in self._owners(top))

    def _owners(self, top: str) -> Mapping[str, str]:
        """Return the distributions that install a top-level module, with their versions."""
        try:
            return {name: metadata.version(name) for name in self.distributions[top]}
        except (KeyError, metadata.PackageNotFoundError):
            installed = _installed(tuple((path, _changed(path)) for path in sys.path))
            names = self.distributions[top] = sorted(set(installed.get(top, ())))
            return {name: metadata.version(name) for name in names}


def _absolute(package: str, references: Iterable[str]) -> Iterator[At]:
    for reference in references:
        module, _, name = reference.partition(":")
        if reference == _ANY:
            continue
        try:
            yield resolve_name(module, package), "" if name == "*" else name
        except ImportError:  # a relative import outside of any package fails when it is run
            continue


@lru_cache(maxsize=1)
def _installed(paths: tuple[tuple[str, int], ...]) -> Mapping[str, list[str]]:
    """Return the distributions that install each top-level module, looked up once.

    Parameters
    ----------
    paths
        Where they lie, with the times at which these folders last changed.
    """
    return metadata.packages_distributions()


def _changed(path: str) -> int:
    try:
        return os.stat(path or ".").st_mtime_ns
    except OSError:
        return 0


@cache
def _pythons_folders() -> tuple[str, ...]:
    folders = (*map(sysconfig.get_path, ("stdlib", "platstdlib")), os.path.dirname(os.__file__))
    return tuple(os.path.join(folder, "") for folder in folders)
