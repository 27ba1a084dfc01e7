"""Which code decides what a function returns: read from source files, without importing them."""

from nodegraph.code.analysis import Code, Reached
from nodegraph.code.sources import SETTLED

__all__ = ["SETTLED", "Code", "Reached"]
