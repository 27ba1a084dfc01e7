"""Where a function stands in its file, and what it was made with."""

from __future__ import annotations

from collections.abc import Iterator
from types import FunctionType
from typing import Any

from nodegraph.code.spots import STATEMENTS, Module, Spot


def made_with(function: FunctionType) -> Iterator[tuple[str, Any]]:
    """Yield by name what a function holds besides its code: cells, defaults, what it wraps."""
    code = function.__code__
    for name, cell in zip(code.co_freevars, function.__closure__ or (), strict=True):
        try:
            yield name, cell.cell_contents
        except ValueError:
            continue  # never bound: nothing was made with it
    defaults = function.__defaults__ or ()
    arguments = code.co_varnames[: code.co_argcount]
    yield from zip(arguments[len(arguments) - len(defaults) :], defaults, strict=True)
    yield from (function.__kwdefaults__ or {}).items()
    if "__wrapped__" in vars(function):
        yield "__wrapped__", vars(function)["__wrapped__"]


def spot_of(module: Module, function: FunctionType) -> Spot | None:
    """Return the name that a function has in its module; its line tells twins apart."""
    code, summary = function.__code__, module.summary
    if summary.trouble:
        return Spot(module, STATEMENTS)
    name = code.co_qualname.partition(".")[0]
    named = summary.names.get(name, ())
    parts = enumerate(summary.parts)
    here = [at for at, part in parts if part.first <= code.co_firstlineno <= part.last]
    twins = [at for at in here if at in named]
    if len(named) > 1 and twins:
        return Spot(module, name, twins[0])
    if named:
        return Spot(module, name)
    return Spot(module, _bound_by(module, here[0]) or name, here[0]) if here else None


def _bound_by(module: Module, part: int) -> str:
    return next((name for name, parts in module.summary.names.items() if part in parts), "")


def is_written_out(spot: Spot, function: FunctionType) -> bool:
    """Whether the source says all that a function was made with: it was not made by another."""
    parts = [spot.part] if spot.part >= 0 else spot.module.summary.names.get(spot.name, ())
    defined = any(spot.module.summary.parts[part].defines for part in parts)
    return defined and "<" not in function.__code__.co_qualname
