"""Tests for any node, ours or a stranger's, and the promises of its family.

>>> from nodegraph.testing import check_node
>>> check_node(hold)  # doctest: +SKIP

A test file of two lines does so for every node of an installed plugin:

>>> from nodegraph.testing import promises_of
>>> test_promises = promises_of("fill")
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nodegraph.equality import difference, same
    from nodegraph.testing.check import check_node
    from nodegraph.testing.promises import promises_of

__all__ = ["check_node", "difference", "promises_of", "same"]

_LATE = {
    "check_node": "nodegraph.testing.check",
    "difference": "nodegraph.equality",
    "promises_of": "nodegraph.testing.promises",
    "same": "nodegraph.equality",
}


def __getattr__(name: str) -> Any:
    # strategies and comparisons need not wait for the machine
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_LATE[name]), name)
