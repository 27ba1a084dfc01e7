"""One thread for each call: sums of numerical libraries depend on how many threads share them.

Steps run side by side instead, which uses the processors better than many small products do.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

_VARIABLES = (
    "BLIS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)  # fmt: skip
"""What the libraries read when they are loaded, which may be in the middle of a run."""


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Have numerical libraries use one thread, those included that are loaded meanwhile.

    It holds for the whole process, until the last of those that asked for it are done.
    """
    _limit.begin()
    try:
        yield
    finally:
        _limit.end()


class _Limit:
    """Whether the limit holds, and for how many."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._holders = 0
        self._open = ExitStack()

    def begin(self) -> None:
        with self._lock:
            self._holders += 1
            if self._holders == 1:
                from threadpoolctl import threadpool_limits

                self._open.enter_context(_variables())
                self._open.enter_context(threadpool_limits(limits=1))

    def end(self) -> None:
        with self._lock:
            self._holders -= 1
            if not self._holders:
                self._open.close()


@contextmanager
def _variables() -> Iterator[None]:
    before = {name: os.environ.get(name) for name in _VARIABLES}
    os.environ.update(dict.fromkeys(_VARIABLES, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name, None)
            if value is not None:
                os.environ[name] = value


_limit = _Limit()
