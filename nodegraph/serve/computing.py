"""Steps that are computed for a reader, as long as the reader waits for them."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import suppress

from nodegraph.execute.results import Run

_EVERY = 0.5
"""Seconds between two looks whether the reader still waits for another computation to end."""

Line = Mapping[str, object]


class Computing:
    """Computes steps in threads, for one request after the other.

    Parameters
    ----------
    message_of
        Returns the message that a reader gets for an error.
    """

    def __init__(self, message_of: Callable[[Exception], str]) -> None:
        self._message_of = message_of
        self._one_at_a_time = threading.Lock()

    async def lines(self, run: Run, steps: Sequence[int]) -> AsyncIterator[Line]:
        """Compute steps; yield how far that is, then ``finished`` or the ``message`` of an error.

        No further step is begun once the iterator is closed.
        """
        queue: asyncio.Queue[Line | None] = asyncio.Queue()
        loop = asyncio.get_running_loop()
        is_left = threading.Event()

        def send(line: Line | None) -> None:
            with suppress(RuntimeError):  # the server has ended
                loop.call_soon_threadsafe(queue.put_nowait, line)

        arguments = (run, steps, send, is_left.is_set)
        # a daemon: a node that never returns must not keep the program alive
        threading.Thread(target=self._compute, args=arguments, daemon=True).start()
        try:
            while (line := await queue.get()) is not None:
                yield line
        finally:
            is_left.set()

    def _compute(
        self,
        run: Run,
        steps: Sequence[int],
        send: Callable[[Line | None], None],
        is_left: Callable[[], bool],
    ) -> None:
        try:
            while not self._one_at_a_time.acquire(timeout=_EVERY):
                send({"waiting": True})
                if is_left():
                    return
            try:
                for advance in run.compute(steps):
                    send(advance._asdict())
                    if is_left():
                        return
            finally:
                self._one_at_a_time.release()
            send({"finished": True})
        except Exception as error:
            send({"message": self._message_of(error)})
        finally:
            send(None)
