"""Tests for any node, third-party ones included, and the promises of its family.

>>> from nodegraph.testing import check_node
>>> check_node(hold)  # doctest: +SKIP

Two lines test every node of an installed plugin:

>>> from nodegraph.testing import promises_of
>>> test_promises = promises_of("fill")
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nodegraph.equality import difference, same
    from nodegraph.testing.check import check_node
    from nodegraph.testing.promises import promises_of

__all__ = ["check_node", "difference", "promises_of", "same"]

_MODULES = {
    "check_node": "nodegraph.testing.check",
    "difference": "nodegraph.equality",
    "promises_of": "nodegraph.testing.promises",
    "same": "nodegraph.equality",
}


def __getattr__(name: str) -> object:
    # a test that needs a comparison alone does not import the whole machine
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_MODULES[name]), name)
