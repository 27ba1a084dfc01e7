"""Whether two values are the same, whatever they are made of; NaN equals NaN."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from io import BytesIO
from typing import Any

import numpy as np

_DOTS_PER_INCH = 50


def same(one: Any, other: Any) -> bool:
    """Return whether two values are the same in every part; NaN equals NaN.

    Looks into dataclasses, records, sequences, mappings, arrays and pandas tables, and at the
    pixels of matplotlib figures. Types, shapes and dtypes count.
    """
    return not difference(one, other)


def difference(one: Any, other: Any, *, name: str = "value") -> str:
    """Return where two values first differ and how, or an empty text if they are the same.

    Parameters
    ----------
    one, other
        As for `same`.
    name
        What the text calls the value.

    Examples
    --------
    >>> difference({"rate": [60, 120]}, {"rate": [60, 100]}, name="take")
    "take['rate'][1]: 120 and 100"
    """
    return _difference(one, other, name, set())


def _difference(one: Any, other: Any, at: str, seen: set[tuple[int, int]]) -> str:
    if one is other or (id(one), id(other)) in seen:
        return ""
    if type(one) is not type(other):
        return f"{at}: {type(one).__name__} and {type(other).__name__}"
    if isinstance(one, np.ndarray) and not one.dtype.hasobject:
        return _array_difference(one, other, at)
    parts = _parts(one)
    if parts is None:
        return "" if _equal(one, other) else f"{at}: {_short(one)} and {_short(other)}"
    seen.add((id(one), id(other)))
    others = _parts(other) or {}
    if parts.keys() != others.keys():
        odd = ", ".join(sorted(f"{at}{part}" for part in parts.keys() ^ others.keys()))
        return f"only one of them has {odd}"
    found = (_difference(part, others[name], f"{at}{name}", seen) for name, part in parts.items())
    return next(filter(None, found), "")


def _parts(value: Any) -> Mapping[str, Any] | None:
    """Return what a value is made of, named as one would write it; None when it is one thing."""
    if is_dataclass(value) and not isinstance(value, type):
        return {f".{field.name}": getattr(value, field.name) for field in fields(value)}
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {f".{name}": getattr(value, name) for name in value._fields}
    if isinstance(value, Mapping):
        return {f"[{key!r}]": part for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return {f"[{place}]": part for place, part in enumerate(value)}
    if isinstance(value, np.ndarray):
        return {".shape": value.shape, ".tolist()": value.tolist()}
    return _foreign_parts(value)


def _foreign_parts(value: Any) -> Mapping[str, Any] | None:
    # by name, so that neither pandas nor matplotlib is imported for what is not theirs
    kinds = {f"{kind.__module__.partition('.')[0]}.{kind.__name__}" for kind in type(value).mro()}
    if "pandas.DataFrame" in kinds:
        columns = {f"[{name!r}]": value.iloc[:, i] for i, name in enumerate(value.columns)}
        metadata = {f".{name}": getattr(value, name, None) for name in value._metadata}
        return {".columns": tuple(value.columns), **columns, ".attrs": value.attrs, **metadata}
    if "pandas.Series" in kinds:
        return {".index": value.index.to_numpy(), ".values": value.to_numpy()}
    if "matplotlib.Figure" in kinds:
        return {".pixels": _pixels(value)}
    compares: Any = type(value).__eq__
    if compares is object.__eq__ and hasattr(value, "__dict__"):
        return {f".{name}": part for name, part in vars(value).items()}
    return None


def _pixels(figure: Any) -> np.ndarray[Any, Any]:
    file = BytesIO()
    figure.savefig(file, format="raw", dpi=_DOTS_PER_INCH)
    return np.frombuffer(file.getvalue(), dtype=np.uint8)


def _array_difference(one: np.ndarray[Any, Any], other: np.ndarray[Any, Any], at: str) -> str:
    if one.dtype != other.dtype or one.shape != other.shape:
        return f"{at}: {one.dtype} {one.shape} and {other.dtype} {other.shape}"
    differs = one != other
    if one.dtype.kind in "fcmM":
        differs &= ~(np.isnan(one) & np.isnan(other))
    if not differs.any():
        return ""
    place = tuple(int(index) for index in np.argwhere(differs)[0])
    spot = f"[{', '.join(map(str, place))}]" if place else ""
    count = np.count_nonzero(differs)
    more = f" ({count} such places)" if count > 1 else ""
    return f"{at}{spot}: {one[place]} and {other[place]}{more}"


def _equal(one: Any, other: Any) -> bool:
    both_nan = isinstance(one, (float, complex)) and one != one and other != other
    return both_nan or bool(one == other)


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
