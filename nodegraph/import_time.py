"""When this program began: code that was edited later may not be what runs."""

from __future__ import annotations

import time

STARTED = time.time_ns()
"""In nanoseconds since 1970, at the first import of this package, before that of any plugin."""

LOADED = "__nodegraph_loaded__"
"""In the variables of a module that was read from a single file: when that was."""
