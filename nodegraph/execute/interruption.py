"""Early ends of a run: Ctrl-C, told from what a node raises, and nodes that end the process."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import NoReturn

_SECONDS_TO_RESPOND = 3
_WATCHER = f"""
import os, select, signal, sys, time
while read := os.read(0, 1):
    if read[0] == signal.SIGINT and not select.select([0], [], [], {_SECONDS_TO_RESPOND})[0]:
        print("nodegraph: interrupted, and ended with a step that does not let go; "
              "finished steps are stored", file=sys.stderr, flush=True)
        os.kill(int(sys.argv[1]), signal.SIGKILL)
        break
else:
    ends = time.monotonic() + 1
    while time.monotonic() < ends and os.getppid() == int(sys.argv[1]):
        time.sleep(0.01)
    if os.getppid() != int(sys.argv[1]):  # else a node has closed the pipe
        print("nodegraph: the process has ended before the run; the same command continues with "
              "what is stored; with --executor processes, a step that ends its process fails alone",
              file=sys.stderr, flush=True)
"""
_HANDLED = b"\0"
_watcher: subprocess.Popen[bytes] | None = None
"""The process that `watched` has started, which reads what happens in this one."""


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
    if _watcher is not None:
        with suppress(OSError):  # if somebody has ended it
            os.write(_pipe_to(_watcher), _HANDLED)
    raise Interruption


def _is_in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()


@contextmanager
def watched() -> Iterator[None]:
    """Say how this process ends, if it does in the middle of a run, and end it if it has to.

    Python responds to Ctrl-C in its main thread, which never runs while C code in another holds
    the interpreter's lock. The signal itself is noted in a pipe without that lock, and another
    process reads the pipe. It also sees that this process is gone.
    """
    global _watcher
    if sys.platform == "win32" or not _is_in_main_thread():
        yield
        return
    words = [sys.executable, "-I", "-S", "-c", _WATCHER, str(os.getpid())]
    # in a session of its own, because Ctrl-C goes to all processes of this one
    _watcher = watcher = subprocess.Popen(words, stdin=subprocess.PIPE, start_new_session=True)
    os.set_blocking(_pipe_to(watcher), False)
    before = signal.set_wakeup_fd(_pipe_to(watcher), warn_on_full_buffer=False)
    try:
        yield
    finally:
        signal.set_wakeup_fd(before)
        _watcher = None
        # it would also end with its input, which a process that a node has forked may keep open
        watcher.kill()
        watcher.wait()
        with suppress(OSError):
            assert watcher.stdin is not None
            watcher.stdin.close()


def end_watcher() -> bool:
    """End the process that `watched` has started, if there is one, without a word from it."""
    if _watcher is not None:
        _watcher.kill()
    return _watcher is not None


def _pipe_to(watcher: subprocess.Popen[bytes]) -> int:
    assert watcher.stdin is not None
    return watcher.stdin.fileno()
