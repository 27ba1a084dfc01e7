"""Dask's own log kept from a user's screen."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager

_NONE = logging.CRITICAL + 1


@contextmanager
def no_logs() -> Iterator[None]:
    """Let Dask log nothing: what a user must know is said by this program, once."""
    names = [one for one in logging.root.manager.loggerDict if one.startswith("distributed")]
    loggers = [logging.getLogger(one) for one in ("distributed", *names)]
    levels = [one.level for one in loggers]
    for one in loggers:
        one.setLevel(_NONE)
    try:
        yield
    finally:
        for one, level in zip(loggers, levels, strict=True):
            one.setLevel(level)
