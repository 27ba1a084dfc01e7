"""Threads that make here what cannot be made elsewhere."""

from __future__ import annotations

import threading
from collections.abc import Callable
from queue import SimpleQueue
from typing import Generic, TypeVar

T = TypeVar("T")


class Helper(Generic[T]):
    """Threads that do something with each thing that they are given.

    Parameters
    ----------
    do
        What to do.
    failed
        Told what `do` raises.
    threads
        How many at a time. They are daemons, because a node that never returns must not keep an
        interrupted program alive.
    """

    def __init__(
        self, do: Callable[[T], None], failed: Callable[[BaseException], None], threads: int = 1
    ) -> None:
        self._do = do
        self._failed = failed
        self._things: SimpleQueue[T | None] = SimpleQueue()
        self._threads = threads
        for _ in range(threads):
            threading.Thread(target=self._work, daemon=True).start()

    def give(self, thing: T) -> None:
        """Have something done."""
        self._things.put(thing)

    def close(self) -> None:
        """Let the threads end, once they have done what they do."""
        for _ in range(self._threads):
            self._things.put(None)

    def _work(self) -> None:
        while (thing := self._things.get()) is not None:
            try:
                self._do(thing)
            except BaseException as error:  # else whoever waits for it waits for ever
                self._failed(error)
            del thing
