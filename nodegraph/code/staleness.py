"""Files that were edited after they were imported: what runs is not what they say."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from nodegraph.code.spots import Module
from nodegraph.started import LOADED, STARTED


def edited_since(modules: Iterable[Module], function: Callable[..., Any]) -> Iterator[str]:
    """Yield what was edited since the program began, or since the module was last read.

    A module that was imported later may be up to date all the same; nothing tells.
    """
    own = getattr(function, "__globals__", {})
    for module in modules:
        there = (
            own if own.get("__file__") == module.file else vars(sys.modules.get(module.name, sys))
        )
        if module.file and (module.name in sys.modules or there is own):
            loaded = there.get(LOADED, STARTED)
            if _changed(module.file) > loaded:
                yield f"{module.name} was edited after it was imported; start the program again"


def _changed(file: str) -> int:
    try:
        return os.stat(file).st_mtime_ns
    except OSError:
        return 0
