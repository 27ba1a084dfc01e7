"""Studies that run in other processes."""

from tests.executors import (
    away,
    fifo,
    listen,
    made_here,
    registry,
    same_as_serial,
    script,
    study,
)

__all__ = ["away", "fifo", "listen", "made_here", "registry", "same_as_serial", "script", "study"]
