"""Kernels: functions that numba compiles, whose machine code is kept in the user's cache folder.

numba itself keeps it in the package. What lies there belongs to no distribution: it stays when the
package is uninstalled, and what remains of the folder looks like a package.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from inspect import signature
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.sigutils import normalize_signature
from platformdirs import user_cache_path

_Function = TypeVar("_Function", bound=Callable[..., object])


def kernel(*written: str, **options: object) -> Callable[[_Function], _Function]:
    """Return a decorator that compiles a function with numba, to run without the GIL.

    The machine code is kept in ``nodegraph/kernels`` in the user's cache folder, or in
    ``NUMBA_CACHE_DIR`` if that is set, and never in the package. Where that cannot be written,
    every process compiles for itself. Machine code belongs to the content of the function's file:
    a change of what a kernel takes from other files of its package, such as constants, options or
    other kernels, goes unnoticed.

    Arrays are best written entry by entry: where one is assigned to a slice, numba compiles the
    message of an error as well, which takes seconds.

    Parameters
    ----------
    *written
        Names of the arguments whose arrays the function writes to. Others are read-only to it,
        so that it is compiled once for arrays that may be written to and arrays that may not.
    **options
        Options of `numba.njit`, such as ``fastmath``; with ``no_cpython_wrapper=True`` only other
        kernels can call the function, which takes a fifth less time to compile.
    """

    def compiled(function: _Function) -> _Function:
        # a tenth of the time to compile would go into a wrapper by which C calls the function
        dispatcher: _Function = numba.njit(nogil=True, no_cfunc_wrapper=True, **options)(function)
        if not numba.config.DISABLE_JIT:
            _lock(dispatcher, written)
            _keep(dispatcher)
        return dispatcher

    return compiled


def _lock(dispatcher: Any, written: Collection[str]) -> None:
    """Make all arrays but some read-only to a kernel, and all numbers variable."""
    names = list(signature(dispatcher.py_func).parameters)
    compiled, known = dispatcher.compile, set[tuple[Any, ...]]()

    def compile_locked(given: Any) -> object:
        types, _ = normalize_signature(given)
        locked = tuple(
            kind if name in written else _locked(kind)
            for name, kind in zip(names, types, strict=True)
        )
        entry = compiled(locked)
        if types != locked and types not in known:
            known.add(types)
            dispatcher._insert([kind._code for kind in types], entry, False)
        return entry

    dispatcher.compile = compile_locked


def _locked(kind: Any) -> Any:
    if isinstance(kind, numba.types.Array):
        return kind.copy(readonly=True)
    if isinstance(kind, numba.types.BaseTuple):
        parts = [_locked(part) for part in kind]
        return numba.types.BaseTuple.from_types(parts, getattr(kind, "instance_class", None))
    # for each number that another kernel writes as an argument, it would be compiled anew
    return numba.types.unliteral(kind)


def _keep(dispatcher: Any) -> None:
    with suppress(OSError):  # a function that is in no file is compiled in every process
        dispatcher._cache = _Cache(dispatcher.py_func)


class _Locator:
    """The folder of a function's machine code: copies of a file share it, and no two versions do.

    numba calls its methods.
    """

    def __init__(self, function: Callable[..., object], file: str) -> None:
        path = Path(file).absolute()
        content = f"numba {numba.__version__}\n".encode() + path.read_bytes()
        self._digest = hashlib.sha256(content).hexdigest()
        self._line = function.__code__.co_firstlineno
        self._py_file = file  # numba names it in warnings
        root = numba.config.CACHE_DIR or user_cache_path("nodegraph") / "kernels"
        self._folder = Path(root) / f"{path.parent.name}-{self._digest[:16]}"

    @classmethod
    def from_function(cls, function: Callable[..., object], file: str) -> _Locator:
        return cls(function, file)

    def ensure_cache_path(self) -> None:
        self._folder.mkdir(parents=True, exist_ok=True)

    def get_cache_path(self) -> str:
        return str(self._folder)

    def get_source_stamp(self) -> str:
        return self._digest

    def get_disambiguator(self) -> str:
        return str(self._line)


class _Storage(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (_Locator,)


class _Cache(FunctionCache):  # type: ignore[misc]
    _impl_class = _Storage

    @contextmanager
    def _guard_against_spurious_io_errors(self) -> Iterator[None]:
        with suppress(OSError):  # a folder that cannot be written, a full disk
            yield
