"""First imports of modules: one thread at a time makes them while calls are made in several.

Python has a lock for each module, and ``import scipy.signal`` does not wait for another thread in
the middle of ``import scipy``. Soon each of the two waits for a module of the other's, and Python
ends this by giving one of them a module that lacks names.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import _bootstrap
from types import ModuleType
from typing import Any

from nodegraph.execute.numeric_threads import SharedContext

_IMPORT: Any = _bootstrap
_SECONDS_TO_WAIT = 30.0
"""An import may itself wait for another thread, or for a lock that this has, for ever."""


@contextmanager
def _in_turn() -> Iterator[None]:
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


imports_in_turn = SharedContext(_in_turn).entered
"""Have only one thread of this process at a time import modules that are not there yet."""
