"""Ctrl-C, which ends a run, told from what a node raises."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

from nodegraph import supervisor


class Interruption(KeyboardInterrupt):
    """Ctrl-C, which ends the run; what a node raises by itself is another `KeyboardInterrupt`."""


def is_interruption(error: KeyboardInterrupt) -> bool:
    """Whether an error that passed through a node was Ctrl-C, as far as that can be told."""
    if isinstance(error, Interruption):
        return True
    handler = signal.getsignal(signal.SIGINT)
    return _is_in_main_thread() and handler is signal.default_int_handler


@contextmanager
def interruptible() -> Iterator[None]:
    """Let `is_interruption` tell Ctrl-C from what nodes raise."""
    is_default = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if not (_is_in_main_thread() and is_default):
        yield
        return
    signal.signal(signal.SIGINT, _interrupt)
    try:
        yield
    except Interruption:
        raise KeyboardInterrupt from None
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
    supervisor.interrupted()
    raise Interruption


def _is_in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()
