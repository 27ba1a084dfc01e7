"""How what stands below shows itself in a notebook: by code above, found by its name."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def in_notebook(function: str, value: Any) -> str:
    """Return what a function of `nodegraph.notebook` shows of a value, as HTML.

    The drawing and the report stand above graphs and runs, and import much; neither is needed
    before somebody looks.
    """
    return str(getattr(import_module("nodegraph.notebook"), function)(value))
