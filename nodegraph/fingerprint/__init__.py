"""Which code decides what a function returns: read from source files, without importing them."""

from nodegraph.fingerprint.code import Code, Reached
from nodegraph.fingerprint.source import SETTLED

__all__ = ["SETTLED", "Code", "Reached"]
