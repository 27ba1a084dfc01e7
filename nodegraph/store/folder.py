"""Where stored results lie."""

from __future__ import annotations

import os
from pathlib import Path

VARIABLE = "NODEGRAPH_STORE"


def store_folder(given: Path | None = None) -> Path:
    """Return the folder of the store: the given one, else NODEGRAPH_STORE, else the platform's."""
    if given is not None:
        return given
    if named := os.environ.get(VARIABLE):
        return Path(named).expanduser()
    from platformdirs import user_cache_path

    return user_cache_path("nodegraph") / "store"
