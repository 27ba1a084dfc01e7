"""One thread for each call: sums of numerical libraries depend on how many threads share them.

Steps run side by side instead, which uses the processors better than many small products do.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from typing import Any


class WhileAny:
    """Holds contexts open while anybody is inside; threads may come and go in any order.

    Parameters
    ----------
    contexts
        Make what the first to come enters, and the last to go leaves.
    """

    def __init__(self, *contexts: Callable[[], AbstractContextManager[Any]]) -> None:
        self._contexts = contexts
        self._lock = threading.Lock()
        self._inside = 0
        self._open = ExitStack()

    @contextmanager
    def on(self) -> Iterator[None]:
        """Be inside."""
        with self._lock:
            self._inside += 1
            if self._inside == 1:
                for context in self._contexts:
                    self._open.enter_context(context())
        try:
            yield
        finally:
            with self._lock:
                self._inside -= 1
                if not self._inside:
                    self._open.close()


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
    with _limit.on():
        yield


@contextmanager
def one_thread_here() -> Iterator[None]:
    """Have OpenMP use one thread for what is called in this thread.

    Its libraries keep the number for each thread, so that the limit of one holds in no other.
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="openmp"):
        yield


def _loaded() -> AbstractContextManager[Any]:
    from threadpoolctl import threadpool_limits

    limits: AbstractContextManager[Any] = threadpool_limits(limits=1)
    return limits


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


_limit = WhileAny(_variables, _loaded)
