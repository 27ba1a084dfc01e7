"""What Python does wrong in several threads at once, one of them does at a time during a run."""

from __future__ import annotations

import ast
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import _bootstrap
from types import ModuleType
from typing import Any

from nodegraph.cache_key import PARSER
from nodegraph.execute.numeric_threads import SharedContext

_IMPORT: Any = _bootstrap
_AST: Any = ast
_SECONDS_TO_WAIT = 30.0
"""An import may itself wait for another thread, or for a lock that this has, for ever."""


@contextmanager
def _first_imports() -> Iterator[None]:
    """Have one thread at a time import modules that are not there yet.

    Python has a lock for each module, and ``import scipy.signal`` does not wait for another thread
    in the middle of ``import scipy``. Soon each of the two waits for a module of the other's, and
    Python ends this by giving one of them a module that lacks names.
    """
    find_and_load: Callable[..., ModuleType] = _IMPORT._find_and_load
    lock = threading.RLock()
    patience = _SECONDS_TO_WAIT

    def wait_and_load(name: str, import_: Callable[..., object]) -> ModuleType:
        nonlocal patience
        if name in sys.modules:
            return find_and_load(name, import_)
        is_ours = lock.acquire(timeout=patience)
        if not is_ours:
            patience = 0.0
        try:
            return find_and_load(name, import_)
        finally:
            if is_ours:
                lock.release()

    # all ways to import lead there, in C too; a finder would be called with the module's lock held
    _IMPORT._find_and_load = wait_and_load
    try:
        yield
    finally:
        _IMPORT._find_and_load = find_and_load


@contextmanager
def _syntax_trees() -> Iterator[None]:
    """Have one thread at a time make a syntax tree.

    NumPy reads the heads of arrays as trees, numba makes one of each function that it compiles,
    and tracebacks of the lines that they show.
    """
    parse: Callable[..., ast.AST] = ast.parse

    def wait_and_parse(*args: object, **kwargs: object) -> ast.AST:
        with PARSER:
            return parse(*args, **kwargs)

    _AST.parse = wait_and_parse
    try:
        yield
    finally:
        _AST.parse = parse


in_turn = SharedContext(_first_imports, _syntax_trees).entered
"""Have the threads of this process import, and make syntax trees, one after another."""
