"""Which code decides what a function returns: read from source files, without importing them."""

from nodegraph.code.analysis import Code, Reached

__all__ = ["Code", "Reached"]
