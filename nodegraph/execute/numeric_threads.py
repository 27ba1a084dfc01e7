"""One thread for each call: sums of numerical libraries depend on how many threads share them.

Steps run side by side instead, which uses the processors better than many small products do.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager

_VARIABLES = (
    "BLIS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)  # fmt: skip
"""Variables that libraries read when they are loaded, possibly in the middle of a run."""


class SharedContext:
    """Contexts of a whole process, which stay open while any thread is inside.

    Parameters
    ----------
    *contexts
        Create what the first thread to come enters, and the last thread to go leaves.
    """

    def __init__(self, *contexts: Callable[[], AbstractContextManager[object]]) -> None:
        self._contexts = contexts
        self._lock = threading.Lock()
        self._inside = 0
        self._stack = ExitStack()

    @contextmanager
    def entered(self) -> Iterator[None]:
        """Be inside; threads may come and go in any order."""
        with self._lock:
            self._inside += 1
            if self._inside == 1:
                for context in self._contexts:
                    self._stack.enter_context(context())
        try:
            yield
        finally:
            with self._lock:
                self._inside -= 1
                if not self._inside:
                    self._stack.close()


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Have numerical libraries use one thread in this process, also those that are loaded later.

    OpenMP is limited in the calling thread only, see `one_thread_here`.
    """
    with _process.entered(), one_thread_here():
        yield


@contextmanager
def one_thread_here() -> Iterator[None]:
    """Have OpenMP use one thread for what is called in this thread.

    OpenMP has a limit for each thread that calls it, while other libraries have one per process.
    """
    with _one_thread("openmp"):
        yield


def _one_thread(api: str) -> AbstractContextManager[object]:
    from threadpoolctl import get_cached_controller

    # selected, because at its end a limit resets all libraries of its controller
    limit: AbstractContextManager[object] = (
        get_cached_controller().select(user_api=api).limit(limits=1)
    )
    return limit


@contextmanager
def _blas() -> Iterator[None]:
    from threadpoolctl import OpenBLASController

    # threadpoolctl lets one thread control OpenBLAS, but runs may begin and end in others
    OpenBLASController.clear_controlling_thread(force=True)
    with _one_thread("blas"):
        yield
        OpenBLASController.clear_controlling_thread(force=True)


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


_process = SharedContext(_variables, _blas)
