"""Keys of steps: everything that decides a result, read from source files and from memory."""

from nodegraph.cache_key.files import FileDigests
from nodegraph.cache_key.functions import Code, Reached
from nodegraph.cache_key.modules import UNKNOWN
from nodegraph.cache_key.sources import PARSER
from nodegraph.cache_key.steps import StepDigest, StepDigests, code_of, followed, step_key

__all__ = [
    "PARSER",
    "UNKNOWN",
    "Code",
    "FileDigests",
    "Reached",
    "StepDigest",
    "StepDigests",
    "code_of",
    "followed",
    "step_key",
]
