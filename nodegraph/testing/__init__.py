"""Tests for any node, ours or a stranger's, and the promises of its family.

>>> from nodegraph.testing import check_node
>>> check_node(hold)  # doctest: +SKIP
"""

from nodegraph.equality import difference, same
from nodegraph.testing.check import check_node

__all__ = ["check_node", "difference", "same"]
