"""The arrays of numbers inside values: where one is infinite, or shared between two calls."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Values = Mapping[str, object]
_NUMBERS = "biufc"
"""The kinds of dtypes of numbers."""


def first_infinite(values: Values) -> str:
    """Return the place of the first infinite number in named values, or an empty text."""
    for place, array in _arrays_of_all(values):
        if array.dtype.kind in "fc" and np.isinf(array).any():
            index = ", ".join(map(str, np.argwhere(np.isinf(array))[0]))
            return f"{place}[{index}]" if index else place
    return ""


def oddities(value: object) -> set[str]:
    """Return the oddities of a value's numbers: infinite, missing, or missing in part."""
    odd: set[str] = set()
    for _, array in _arrays(value, ""):
        if array.dtype.kind in "fc" and not np.isfinite(array).all():
            nan = np.isnan(np.atleast_1d(array))
            odd |= {"infinite"} if np.isinf(array).any() else set()
            odd |= {"missing"} if nan.any() else set()
            odd |= {"missing in part"} if np.any(nan.any(-1) & ~nan.all(-1)) else set()
    return odd


def first_shared(first: Values, second: Values, inputs: Values) -> str:
    """Return which array the outputs of two calls share that no input has, or an empty text."""
    pairs = zip(_arrays_of_all(first), _arrays_of_all(second), strict=False)
    for (place, array), (_, other) in pairs:
        if np.shares_memory(array, other) and not any(
            np.shares_memory(array, each) for _, each in _arrays_of_all(inputs)
        ):
            return place
    return ""


def _arrays_of_all(values: Values) -> Iterator[tuple[str, NDArray[np.generic]]]:
    for name, value in values.items():
        yield from _arrays(value, name)


def _arrays(value: object, name: str) -> Iterator[tuple[str, NDArray[np.generic]]]:
    """Yield the arrays of numbers in a value, each with the expression that reaches it."""
    if isinstance(value, (np.ndarray, float)):
        array = np.asarray(value)
        if array.dtype.kind in _NUMBERS:
            yield name, array
    for suffix, part in _parts(value):
        if not isinstance(part, str):  # names are many
            yield from _arrays(part, f"{name}{suffix}")


def _parts(value: Any) -> Iterable[tuple[str, object]]:
    if is_dataclass(value) and not isinstance(value, type):
        return ((f".{each.name}", getattr(value, each.name, None)) for each in fields(value))
    if isinstance(value, Mapping):
        return ((f"[{key!r}]", part) for key, part in value.items())
    if isinstance(value, (list, tuple)):
        return ((f"[{index}]", part) for index, part in enumerate(value))
    if hasattr(value, "columns") and hasattr(value, "iloc"):
        kinds = zip(value.columns, value.dtypes, strict=True)
        numbers = (column for column, kind in kinds if kind.kind in _NUMBERS)
        return ((f"[{column!r}]", value[column].to_numpy()) for column in numbers)
    return ()
