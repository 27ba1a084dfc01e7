"""The time of the imports: source files that were edited later may not be the code that runs."""

from __future__ import annotations

import time

STARTED = time.time_ns()
"""Nanoseconds since 1970 at the first import of this package, which precedes that of any plugin."""

LOADED = "__nodegraph_loaded__"
"""The variable of a module loaded from a single file that holds the time of its import."""
