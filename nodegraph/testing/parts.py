"""What values hold: their arrays, whose memory they are, and where a number is infinite."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


def arrays(value: Any, name: str = "") -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield the arrays of numbers in a value, each named as one would write it.

    Looks into dataclasses, sequences, mappings and pandas tables.

    Parameters
    ----------
    value
        Anything; arrays are looked for inside of it.
    name
        What it is called.
    """
    if isinstance(value, (np.ndarray, float)):
        array = np.asarray(value)
        if array.dtype.kind in "biufc":
            yield name, array
    for part, held in _parts(value):
        yield from arrays(held, f"{name}{part}")


def _parts(value: Any) -> Iterable[tuple[str, Any]]:
    if is_dataclass(value) and not isinstance(value, type):
        return ((f".{one.name}", getattr(value, one.name, None)) for one in fields(value))
    if isinstance(value, Mapping):
        return ((f"[{key!r}]", held) for key, held in value.items())
    if isinstance(value, (list, tuple)):
        return ((f"[{place}]", held) for place, held in enumerate(value))
    if hasattr(value, "columns") and hasattr(value, "iloc"):
        return ((f"[{one!r}]", value[one].to_numpy()) for one in value.columns)
    return ()


def infinite(values: Mapping[str, Any]) -> str:
    """Return the place of an infinite number in values by name, or an empty text.

    Parameters
    ----------
    values
        Values by name.
    """
    for place, array in _of_all(values):
        if array.dtype.kind in "fc" and np.isinf(array).any():
            index = ", ".join(str(one) for one in np.argwhere(np.isinf(array))[0])
            return f"{place}[{index}]" if index else place
    return ""


def oddities(value: Any) -> set[str]:
    """Return what is odd about the numbers of a value: infinite, missing, or missing in part.

    Parameters
    ----------
    value
        Anything; numbers are looked for inside of it.
    """
    found: set[str] = set()
    for _, array in arrays(value):
        if array.dtype.kind in "fc" and not np.isfinite(array).all():
            nan = np.isnan(np.atleast_1d(array))
            found |= {"infinite"} if np.isinf(array).any() else set()
            found |= {"missing"} if nan.any() else set()
            found |= {"missing in part"} if np.any(nan.any(-1) & ~nan.all(-1)) else set()
    return found


def kept_between(one: Mapping[str, Any], other: Mapping[str, Any], given: Mapping[str, Any]) -> str:
    """Return which array the outcomes of two calls share that no input has, or an empty text.

    Parameters
    ----------
    one, other
        What came out of two calls, by port.
    given
        What went in, whose arrays may come out again.
    """
    theirs = [array for _, array in _of_all(given)]
    for (place, first), (_, second) in zip(_of_all(one), _of_all(other), strict=False):
        if _overlap(first, second) and not any(_overlap(first, array) for array in theirs):
            return place
    return ""


def _of_all(values: Mapping[str, Any]) -> Iterator[tuple[str, NDArray[Any]]]:
    for name, value in values.items():
        yield from arrays(value, name)


def _overlap(one: NDArray[Any], other: NDArray[Any]) -> bool:
    return bool(one.size) and np.may_share_memory(one, other) and np.shares_memory(one, other)
