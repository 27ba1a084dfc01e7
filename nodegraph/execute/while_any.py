"""Contexts of the whole process, which several threads may ask for at once."""

from __future__ import annotations

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
