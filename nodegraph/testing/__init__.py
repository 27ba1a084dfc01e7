"""Tests for any node, ours or a stranger's, and the promises of its family.

>>> from nodegraph.testing import check_node
>>> check_node(hold)  # doctest: +SKIP
"""

from nodegraph.testing.check import check_node
from nodegraph.testing.equality import difference, same

__all__ = ["check_node", "difference", "same"]
