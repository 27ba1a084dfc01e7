"""Functions as they are in memory: which modules define them, and what they were made with."""

from __future__ import annotations

import copyreg
import dis
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from types import CodeType, FunctionType, MappingProxyType, ModuleType, NoneType
from typing import Any

from nodegraph.cache_key.files import FileMemo
from nodegraph.cache_key.modules import Modules, ReferencedCode
from nodegraph.cache_key.sources import digest_of
from nodegraph.import_time import LOADED, STARTED
from nodegraph.plugin.hook_types import Format

_PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"
_FORM = f"4 {_PYTHON}"
"""Version of the remembered digests; it must change when sources are read in another way."""
_FORMATS = "nodegraph.plugin.formats"
_PLAIN = (NoneType, bool, int, float, complex, str, range, type(...))
_MAPPINGS = (dict, MappingProxyType)
_NO_CODE = {
    "__dict__", "__doc__", "__firstlineno__", "__module__", "__static_attributes__",
    "__weakref__", "_abc_impl",
}  # fmt: skip
"""Members of a class that decide nothing."""


@dataclass(frozen=True)
class Reached:
    """The code that a function reaches.

    Attributes
    ----------
    digest : str
        Digest of all of it.
    units : mapping of str to digest
        Every module whose code counts; functions without a file, and those that were made with
        values, as ``module:function``; formats of files as ``format:name``.
    versions : mapping of distribution to version
        Versions of all other code; ``python`` stands for its standard library too.
    unstable : str
        Why an equal digest would not mean equal code; empty when it does.
    """

    digest: str
    units: Mapping[str, str]
    versions: Mapping[str, str]
    unstable: str = ""


class Code:
    """Finds the code that functions reach, without importing anything.

    Each file is read once in the life of this object: make another after an edit.

    Parameters
    ----------
    followed
        Top-level modules whose code counts wherever they lie, those of all plugins. So does that
        of modules that were not installed. Of every other module the version counts.
    remembered
        The result of `remembered` in an earlier process.
    formats
        Returns the formats of the plugins in use: a function that calls `nodegraph.formats` reaches
        the code of all of them.
    """

    def __init__(
        self,
        followed: Iterable[str],
        remembered: Mapping[str, Any] | None = None,
        formats: Callable[[], Iterable[Format]] = tuple,
    ) -> None:
        known = remembered if remembered and remembered.get("form") == _FORM else {}
        self._memo = FileMemo(known.get("sources"))
        self._modules = Modules(followed, self._memo)
        self._formats = formats
        self._known: dict[int, tuple[object, Reached]] = {}

    def of(self, function: Callable[..., object]) -> Reached:
        """Return the code that a function reaches, found once in the life of this object."""
        if id(function) not in self._known:
            # the function is kept with it, so that no other one can get its id
            self._known[id(function)] = function, self._find(function)
        return self._known[id(function)][1]

    def remembered(self) -> dict[str, object]:
        """Return data that a later process need not read again, as plain values for JSON."""
        return {"form": _FORM, "sources": self._memo.remembered}

    def _find(self, function: Callable[..., object]) -> Reached:
        values = _Values(self._modules)
        text, troubles = values.text(function)
        units = {} if _reference(function) else {_label(function): digest_of(text)}
        reach = self._modules.reach(values.references)
        if _FORMATS in reach.digests:
            for form in self._formats():
                described, more = values.text((form.suffixes, form.read, form.recognizes))
                units[f"format:{form.name}"] = digest_of(described)
                troubles += more
            reach = self._modules.reach(values.references)
        units = dict(sorted((reach.digests | units).items()))
        versions = {"python": _PYTHON, **dict(sorted(reach.versions.items()))}
        troubles += [*reach.troubles, *_edited(reach, values.loaded)]
        return Reached(
            sha256(repr((text, units, versions)).encode("utf-8", "surrogatepass")).hexdigest(),
            units,
            versions,
            "; ".join(dict.fromkeys(troubles)),
        )


def _edited(reach: ReferencedCode, loaded: Mapping[str, int]) -> Iterator[str]:
    """Yield which files were edited since the program began, or since they were last imported.

    A module that was imported later may be up to date all the same; that is not known.
    """
    for name, (file, time) in sorted(reach.edited.items()):
        module = sys.modules.get(name)
        since = loaded.get(file) or (module and vars(module).get(LOADED, STARTED))
        if since and time > since:
            yield f"{name} was edited after it was imported; start the program again"


class _NoDigestError(Exception):
    """A value that cannot be described."""


class _Values:
    """Describes values, and functions by their bytecode and all that they hold.

    Attributes
    ----------
    references : list of str
        To the modules that they come from.
    loaded : dict of file to time
        When functions were imported from it.
    """

    def __init__(self, modules: Modules) -> None:
        self._modules = modules
        self._seen: dict[int, tuple[object, int]] = {}
        self.references: list[str] = []
        self.loaded: dict[str, int] = {}

    def text(self, value: object) -> tuple[str, list[str]]:
        """Return the description of a value as a text, and why there is none."""
        try:
            return repr(self._of(value)), []
        except _NoDigestError as error:
            return "", [f"{_label(value)} {error}"]
        except RecursionError:
            return "", [f"{_label(value)} holds a value that is nested too deeply to be read"]

    def _of(self, value: Any) -> object:
        kind = type(value)
        if kind in _PLAIN:
            return kind.__name__, repr(value)
        if kind is bytes:
            return "bytes", sha256(value).hexdigest()
        if kind in (list, tuple):
            return kind.__name__, [self._of(part) for part in value]
        if kind in (set, frozenset):
            return kind.__name__, sorted(repr(self._of(part)) for part in value)
        if kind in _MAPPINGS:
            return kind.__name__, [(self._of(key), self._of(part)) for key, part in value.items()]
        if kind is CodeType:
            return self._bytecode(value)
        if id(value) in self._seen:
            return "seen", self._seen[id(value)][1]
        # the value is kept with it, so that no other one can get its id
        self._seen[id(value)] = value, len(self._seen)
        return self._made_of_code(value)

    def _made_of_code(self, value: Any) -> object:
        kind = type(value)
        if kind is ModuleType:
            self.references.append(f"{value.__name__}:")
            return "module", value.__name__
        if reference := _reference(value):
            self.references.append(reference)
            return "named", reference
        if kind is FunctionType:
            return self._function(value)
        if isinstance(value, type):
            members = {name: part for name, part in vars(value).items() if name not in _NO_CODE}
            return "class", value.__qualname__, self._of(value.__bases__), self._of(members)
        if kind is property:
            return "property", self._of((value.fget, value.fset, value.fdel))
        if hasattr(value, "__wrapped__"):
            return kind.__name__, self._of(value.__wrapped__)
        return self._instance(value)

    def _instance(self, value: Any) -> object:
        """Describe a value by what `pickle` would write of it."""
        kind = type(value)
        try:
            if "random" in kind.__module__.split(".") or isinstance(value, Iterator):
                raise TypeError("another value after each use")
            reduce = copyreg.dispatch_table.get(kind)
            reduced = reduce(value) if reduce else value.__reduce_ex__(4)
        except Exception as error:
            text = f"holds a {kind.__qualname__}, of which no digest can be made"
            raise _NoDigestError(text) from error
        if isinstance(reduced, str):
            return self._of(kind), reduced
        make, arguments, state, *parts = (*reduced, None)[:6]
        return self._of((make, arguments, state, *(part and tuple(part) for part in parts)))

    def _function(self, function: FunctionType) -> object:
        code = function.__code__
        held = [_content(cell) for cell in function.__closure__ or ()]
        held += [function.__defaults__, function.__kwdefaults__, vars(function).get("__wrapped__")]
        if os.path.isfile(code.co_filename):
            file = os.path.abspath(code.co_filename)
            self.references.append(f"{self._modules.add(file, _module_name(function))}:")
            self.loaded[file] = function.__globals__.get(LOADED, STARTED)
        else:
            for part in _all_code(code):
                names = sorted(set(part.co_names) & set(function.__globals__))
                held += [(name, function.__globals__[name]) for name in names]
                self.references += [
                    f"{step.argval}:"
                    for step in dis.get_instructions(part)
                    if step.opname == "IMPORT_NAME"
                ]
        return "function", self._bytecode(code), self._of(held)

    def _bytecode(self, code: CodeType) -> object:
        documented = (
            code.co_flags & 0x4000000
            if sys.version_info >= (3, 14)
            else (code.co_flags & 1 and not code.co_name.startswith("<"))
        )
        return (
            code.co_name,
            code.co_flags,
            (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount),
            (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars),
            code.co_code,
            code.co_exceptiontable,
            self._of(code.co_consts[bool(documented) :]),
        )


def _all_code(code: CodeType) -> Iterator[CodeType]:
    yield code
    for part in code.co_consts:
        if isinstance(part, CodeType):
            yield from _all_code(part)


def _content(cell: Any) -> object:
    try:
        return cell.cell_contents
    except ValueError:  # never bound: nothing can depend on it
        return None


def _reference(value: Any) -> str:
    """Return ``module:name`` if a module with a location has a value under its own name."""
    home, name = getattr(value, "__module__", None), getattr(value, "__qualname__", None)
    module = sys.modules.get(home) if isinstance(home, str) else None
    if module is None or not isinstance(name, str) or home == "__main__":
        return ""
    if not (getattr(module, "__spec__", None) or getattr(module, "__file__", None)):
        return ""
    found: Any = module
    for part in name.split("."):
        found = getattr(found, part, None)
    return f"{home}:{name}" if found is value else ""


def _module_name(function: FunctionType) -> str:
    name = str(function.__globals__.get("__name__", "__main__"))
    spec = function.__globals__.get("__spec__")
    if name == "__main__":
        return spec.name if spec else Path(function.__code__.co_filename).stem
    return name


def _label(value: object) -> str:
    home = getattr(value, "__module__", None) or type(value).__module__
    return f"{home}:{getattr(value, '__qualname__', type(value).__qualname__)}"
