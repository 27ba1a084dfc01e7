"""A process that waits for the program, and responds where the program can no longer do so.

It is forked before anything is imported that takes time or starts threads, so that whatever ends
the program, such as a node in C, does not end it, and it returns success only if the program has
said so. Python responds to Ctrl-C in its main thread, which never runs while C code in another
thread holds the interpreter's lock: then it ends the program.

Without `supervise`, as where nodegraph is a library, what is said here is read by nobody.
"""

from __future__ import annotations

import mmap
import os
import signal
import sys
import time
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NoReturn

_SIZE = 4096
_FINISHED, _STATUS, _RUN, _NAMES = range(4)
"""Places in the page; from the last one on stand the names of the nodes that run."""
_NO_RUN, _IN_RUN, _INTERRUPTED = range(3)
_PATIENCE = {_NO_RUN: None, _IN_RUN: 3.0, _INTERRUPTED: 10.0}
"""Seconds from Ctrl-C until a run is ended that does not respond, or has, and does not end."""
_NO_RESPONSE = "interrupted, and ended with a step that does not let go; finished steps are stored"

_page: mmap.mmap | bytearray = bytearray(_SIZE)
"""What the program says: memory of both processes, which no node can close as it could a pipe."""


def finished(status: int) -> None:
    """Say that the program has done its work, and what its exit status is."""
    _page[_STATUS] = status & 0xFF  # as the operating system does
    _page[_FINISHED] = 1


def interrupted() -> None:
    """Say that Ctrl-C ends the run."""
    _page[_RUN] = _INTERRUPTED


def running(names: Iterable[str]) -> None:
    """Say which nodes are running."""
    text = ", ".join(names).encode()[: _SIZE - _NAMES - 1]
    _page[_NAMES : _NAMES + len(text) + 1] = text + b"\0"


@contextmanager
def in_run() -> Iterator[None]:
    """Say that a run begins, and that it ends."""
    _page[_RUN] = _IN_RUN
    try:
        yield
    finally:
        _page[_RUN] = _NO_RUN


def supervise() -> None:
    """Go on in another process, while this one waits for it and ends as it does."""
    global _page
    if sys.platform != "linux":
        return
    from ctypes import CDLL, c_ulong

    prctl = CDLL(None).prctl
    _page = mmap.mmap(-1, _SIZE)
    supervisor = os.getpid()
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    passed = {signal.Signals[name] for name in _PASSED}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGCHLD, *passed})
    program = os.fork()
    if program:
        prctl(_PR_SET_CHILD_SUBREAPER, c_ulong(1))
        _end_as(*_wait_for(program, passed))
    prctl(_PR_SET_PDEATHSIG, c_ulong(signal.SIGKILL))
    if os.getppid() != supervisor:
        os._exit(1)  # it has ended before the line above
    signal.pthread_sigmask(signal.SIG_SETMASK, before)


_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36  # of linux/prctl.h
_PASSED = ("SIGHUP", "SIGINT", "SIGQUIT", "SIGTERM", "SIGUSR1", "SIGUSR2")


def _wait_for(program: int, passed: Collection[signal.Signals]) -> tuple[int, bool]:
    """Pass signals on to the program until it ends; return how it did, and whether one was sent."""
    awaited = {signal.SIGCHLD, *passed}
    is_asked = False
    since: float | None = None
    while True:
        patience = _PATIENCE[_page[_RUN]]
        sent: signal.struct_siginfo | None
        if patience is None or since is None:
            since = None
            sent = signal.sigwaitinfo(awaited)
        else:
            sent = signal.sigtimedwait(awaited, max(since + patience - time.monotonic(), 0.0))
        ended, how = os.waitpid(program, os.WNOHANG)
        if ended:
            return how, is_asked
        if sent is None:
            if _PATIENCE[_page[_RUN]] == patience:
                _say(_NO_RESPONSE)
                finished(130)
                os.kill(program, signal.SIGKILL)
                return os.waitpid(program, 0)[1], is_asked
        elif sent.si_signo != signal.SIGCHLD:
            is_asked = True
            if sent.si_code <= 0:  # else the terminal has sent it to both processes
                os.kill(program, sent.si_signo)
            if sent.si_signo == signal.SIGINT and signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
                since = since or time.monotonic()


def _end_as(how: int, is_asked: bool) -> NoReturn:
    """End this process as the program has said that it would, or else as it did end."""
    _end_forks()
    if _page[_FINISHED]:
        os._exit(_page[_STATUS])
    code = os.waitstatus_to_exitcode(how)
    if not is_asked:
        _say(_unfinished(code))
    if code < 0:
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # the program has left its own
        if -code != signal.SIGKILL:
            signal.signal(-code, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_SETMASK, [])
        os.kill(os.getpid(), -code)
    os._exit(code or 1)


def _unfinished(code: int) -> str:
    """Return how the program ended before it had finished."""
    how = f"has ended with exit status {code}"
    if code < 0:
        number = -code
        name = signal.Signals(number).name if number in set(signal.Signals) else str(number)
        how = f"was ended by signal {name}{' (out of memory?)' if name == 'SIGKILL' else ''}"
    if not _page[_RUN]:
        return f"the process {how} before it was finished"
    names = _page[_NAMES:].partition(b"\0")[0].decode(errors="replace")
    return (
        f"the process {how} before the run was finished{f', while {names} ran' if names else ''}; "
        "the same command continues with what is stored; with --executor processes, a step that "
        "ends its process fails alone"
    )


def _say(text: str) -> None:
    with suppress(OSError):
        os.write(2, f"nodegraph: {text}\n".encode())


def _end_forks() -> None:
    """End the processes that C code in nodes has forked from the program.

    Such a process cannot end by itself if another thread held Python's interpreter lock when it
    was forked: it waits for that thread, which it does not have. Whoever reads the output of this
    program to its end would wait for it.
    """
    with suppress(OSError):
        words = Path("/proc/self/cmdline").read_bytes()
        for child in map(int, Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()):
            with suppress(OSError):
                # one that has started another program has other words
                if Path(f"/proc/{child}/cmdline").read_bytes() == words:
                    os.kill(child, signal.SIGKILL)
