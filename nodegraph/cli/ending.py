"""The end of the program: at once, and with its own status, whatever nodes have left behind."""

from __future__ import annotations

import atexit
import os
import signal
import sys
import threading
from contextlib import suppress
from functools import cache
from pathlib import Path

_SECONDS_TO_END = 5.0
_status: int | None = None
_exit = os._exit  # which nodes may not call


def begin() -> None:
    """Have the program end as `end_with` says, which must be called before others use `atexit`."""
    global _status
    _status = 1
    atexit.register(_end)


def end_with(status: int) -> None:
    """End the program with a status: after what `atexit` calls, but after five seconds at most."""
    global _status
    _status = status
    end = threading.Timer(_SECONDS_TO_END, _end)
    end.daemon = True
    end.start()


def _end() -> None:
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):
            stream.flush()
    _end_forks()
    _exit(_status or 0)


def _end_forks() -> None:
    """End the processes that C code in nodes has forked from this one, as far as /proc tells.

    Such a process cannot end by itself if another thread held Python's interpreter lock when it
    was forked: it waits for that thread, which it does not have. Whoever reads the output of this
    program to its end would wait for it.
    """
    with suppress(OSError):
        words = Path("/proc/self/cmdline").read_bytes()
        for children in Path("/proc/self/task").glob("*/children"):
            for child in map(int, children.read_text().split()):
                with suppress(OSError):
                    # one that has started another program has other words
                    if Path(f"/proc/{child}/cmdline").read_bytes() == words:
                        os.kill(child, signal.SIGKILL)


@cache
def refuse_exits() -> object:
    """Have no call of C's ``exit``, such as that of a library, end a run with success.

    Nothing can be done against C code that ends the process without ``exit``.

    Returns
    -------
    object
        To be kept for as long as the program runs.
    """
    if _status is None:
        return None  # Python will be gone when this would be called
    import ctypes

    from nodegraph.execute.call_notes import notes_of_call
    from nodegraph.execute.interruption import end_watcher

    process = os.getpid()

    def respond(nothing: object) -> None:
        if os.getpid() == process and end_watcher():
            notes = notes_of_call.get()
            name = notes.node.name if notes is not None else "a node"
            text = (
                f"nodegraph: {name} has ended the process before the run was finished; the same "
                "command continues with what is stored; with --executor processes, such a step "
                "fails alone\n"
            )
            os.write(2, text.encode())
            _exit(1)

    called = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(respond)
    with suppress(AttributeError, OSError):  # a system without this function
        ctypes.CDLL(None).__cxa_atexit(called, None, None)
    return called
