"""The end of the program: at once, and with its own status, whatever nodes have left behind."""

from __future__ import annotations

import atexit
import os
import sys
import threading
from contextlib import suppress
from typing import NoReturn

from nodegraph import supervisor

_SECONDS_TO_END = 5.0
_status = 1


def begin() -> None:
    """Have the program end as `end_with` says, which must be called before others use `atexit`."""
    supervisor.supervise()
    atexit.register(_end)


def end_with(status: int) -> NoReturn:
    """End the program with a status: after what `atexit` calls, but after five seconds at most."""
    global _status
    _status = status
    supervisor.finished(status)
    end = threading.Timer(_SECONDS_TO_END, _end)
    end.daemon = True
    end.start()
    sys.exit(status)


def _end() -> None:
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):
            stream.flush()
    os._exit(_status)
