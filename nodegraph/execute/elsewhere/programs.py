"""Starting Python programs of our own, and telling how they ended.

They are not started by `multiprocessing`, whose children run the user's own script once more
before anything else: one without ``if __name__ == "__main__":`` would start itself again and again.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from contextlib import suppress

_START = (
    "import json, sys, importlib; "
    "module, sys.path[:] = json.loads(sys.argv.pop(1)); "
    "importlib.import_module(module).main()"
)


def start(module: str, *words: str, answers: bool = False) -> subprocess.Popen[bytes]:
    """Start ``module.main()`` in another process, which finds modules where this one does.

    Its standard input is a pipe, whose end tells it to end. It is not in the foreground of the
    terminal: Ctrl-C reaches this process alone.

    Parameters
    ----------
    module
    *words
        Its ``sys.argv[1:]``.
    answers
        Whether its standard output is a pipe, too.
    """
    return subprocess.Popen(
        [
            sys.executable,
            "-P",
            "-c",
            _START,
            json.dumps([module, list(map(str, sys.path))]),
            *words,
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE if answers else None,
        start_new_session=True,
    )


def kill(process: subprocess.Popen[bytes]) -> None:
    """End a program, and what it has started itself, at once."""
    if process.returncode is not None:
        return  # its number may be another's by now
    with suppress(ProcessLookupError):
        if sys.platform == "win32":
            process.kill()
        else:
            os.killpg(process.pid, signal.SIGKILL)


def how_it_ended(process: subprocess.Popen[bytes]) -> str:
    """Return how a program ended that has closed its pipes."""
    try:
        status = process.wait(timeout=5)
    except subprocess.TimeoutExpired:  # it has not ended, but nobody can talk to it any more
        kill(process)
        process.wait()
        return "closed its pipes"
    if status >= 0:
        return f"ended with exit status {status}"
    number = -status
    name = signal.Signals(number).name if number in set(signal.Signals) else str(number)
    hint = " (out of memory?)" if name == "SIGKILL" else ""
    return f"was ended by signal {name}{hint}"
