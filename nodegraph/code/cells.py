"""Functions that no file holds: from a notebook's cell, a prompt or ``exec``."""

from __future__ import annotations

import ast
import inspect
import textwrap
from types import CodeType, FunctionType
from typing import NamedTuple

from nodegraph.code.parts import short_digest
from nodegraph.code.summary import part_of
from nodegraph.code.syntax import Marks


class Cell(NamedTuple):
    """A function that no file holds.

    Attributes
    ----------
    digest : str
    references : tuple of str
        As those of a `Part`, or, without any source, all names that its code mentions.
    found : str
        ``cell`` when its source was kept, else ``compiled``.
    """

    digest: str
    references: tuple[str, ...]
    found: str


def read_cell(function: FunctionType, marks: Marks) -> Cell:
    """Return a function's code, from kept source if there is any, else as it was compiled."""
    code = function.__code__
    try:
        # of the code: a function would be unwrapped, and another one's source returned
        statement = ast.parse(textwrap.dedent(inspect.getsource(code))).body[0]
    except (OSError, TypeError, SyntaxError, ValueError, IndexError):
        return Cell(short_digest(_instructions(code)), tuple(sorted(_names(code))), "compiled")
    part = part_of(statement, marks)
    return Cell(part.digest, part.references, "cell")


def _instructions(code: CodeType) -> tuple[object, ...]:
    constants = tuple(map(_constant, code.co_consts))
    names = (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)
    return code.co_code, code.co_exceptiontable, constants, names, code.co_flags


def _constant(value: object) -> object:
    if isinstance(value, CodeType):
        return _instructions(value)
    if isinstance(value, tuple):
        return tuple(map(_constant, value))
    if isinstance(value, frozenset):
        return sorted(map(repr, value))
    return type(value).__name__, repr(value)


def _names(code: CodeType) -> set[str]:
    inner = (one for one in code.co_consts if isinstance(one, CodeType))
    return set(code.co_names).union(*map(_names, inner))
