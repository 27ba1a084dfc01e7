"""A table as plain values: it comes back exactly, or is refused."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from nodegraph_tables.frame import TableFrame
from nodegraph_tables.info import TableInfo, info_of, with_info

_MASKED: dict[str, Any] = {
    "integer": pd.arrays.IntegerArray,
    "floating": pd.arrays.FloatingArray,
    "boolean": pd.arrays.BooleanArray,
}
_INDICES = (pd.Index, pd.DatetimeIndex, pd.TimedeltaIndex, pd.CategoricalIndex)
_LONGEST_RANGE = 2**26
"""Rows of a range, which needs no memory until it is used."""


def take_apart(table: pd.DataFrame) -> dict[str, Any]:
    """Return the plain values from which `put_together` makes an equal table.

    Raises
    ------
    TypeError
        If there are none.
    """
    if type(table) not in (pd.DataFrame, TableFrame):
        raise TypeError(f"{type(table).__name__} is more than a DataFrame")
    places = range(table.shape[1])
    parts = {
        "columns": _index_parts(table.columns),
        "index": _index_parts(table.index),
        "data": [_array_parts(table.iloc[:, place], table.columns[place]) for place in places],
        "attrs": table.attrs,
        "unique": not table.flags.allows_duplicate_labels,
    }
    if type(table) is TableFrame:
        info = info_of(table)
        parts["info"] = {field.name: getattr(info, field.name) for field in fields(info)}
    return parts


def put_together(parts: dict[str, Any]) -> pd.DataFrame:
    """Return the table again.

    Raises
    ------
    ValueError
        If these are not the parts of a table.
    """
    index = _index(parts["index"])
    arrays = [_array(column) for column in parts["data"]]
    if any(array.shape != (len(index),) for array in arrays):
        raise ValueError("a column is not as long as the index")
    columns = {
        place: pd.Series(array, index=index, dtype=array.dtype)
        for place, array in enumerate(arrays)
    }
    table = pd.DataFrame(columns, index=index)
    table.columns = _index(parts["columns"])
    table.attrs = parts["attrs"]
    table = table.set_flags(allows_duplicate_labels=not parts["unique"])
    return with_info(table, TableInfo(**parts["info"])) if "info" in parts else table


def _index_parts(index: pd.Index[Any]) -> tuple[object, ...]:
    if type(index) is pd.RangeIndex:
        _bounded(index)
        return ("range", index.start, index.stop, index.step, index.name)
    if type(index) is pd.MultiIndex:
        levels = [_index_parts(level) for level in index.levels]
        codes = [np.asarray(level) for level in index.codes]
        return ("multi", levels, codes, list(index.names))
    if type(index) not in _INDICES or getattr(index, "freq", None) is not None:
        raise TypeError(f"the index, a {type(index).__name__}, cannot be kept exactly")
    return ("index", _array_parts(index, "index"), index.name)


def _index(parts: tuple[Any, ...]) -> pd.Index[Any]:
    match parts:
        case ("range", int(start), int(stop), int(step), name):
            return _bounded(pd.RangeIndex(start, stop, step, name=name))
        case ("multi", [*levels], [*codes], [*names]):
            return _multi_index([_index(level) for level in levels], codes, names)
        case ("index", values, name):
            array = _array(values)
            index: pd.Index[Any] = pd.Index(array, dtype=array.dtype, name=name)
            return index
    raise ValueError("these are not the parts of an index")


def _bounded(index: pd.RangeIndex) -> pd.RangeIndex:
    if len(index) > _LONGEST_RANGE:
        raise ValueError(f"a range of {len(index)} rows is too long for an index")
    return index


def _multi_index(levels: Any, codes: list[Any], names: list[object]) -> pd.MultiIndex:
    # pandas uses codes without any check of its own
    for level, code in zip(levels, codes, strict=True):
        if code.dtype.kind != "i" or code.shape != (len(codes[0]),):
            raise ValueError("the codes of a level are not integers, one per row")
        if isinstance(level, pd.MultiIndex):
            raise ValueError("a level has levels")
        if len(code) and not -1 <= code.min() <= code.max() < len(level):
            raise ValueError("a code is beyond its level")
    return pd.MultiIndex(levels=levels, codes=codes, names=names, verify_integrity=False)


def _array_parts(values: pd.Series[Any] | pd.Index[Any], name: object) -> tuple[object, ...]:
    """Return what a column, or an index, is made of."""
    dtype: Any = values.dtype
    array: Any = values.array
    if isinstance(dtype, np.dtype):
        plain = values.to_numpy()
        return ("objects", list(plain)) if dtype.kind == "O" else ("numpy", plain.copy())
    if isinstance(dtype, pd.CategoricalDtype):
        return ("categorical", array.codes, _index_parts(dtype.categories), dtype.ordered)
    if isinstance(dtype, pd.StringDtype):
        texts = [
            None if missing else text for text, missing in zip(array, array.isna(), strict=True)
        ]
        # not how pandas holds it, which depends on whether pyarrow is installed
        return ("text", texts, dtype.na_value is pd.NA)
    for kind, masked in _MASKED.items():
        if type(array) is masked:
            missing = array.isna()
            return (kind, array.to_numpy(dtype.numpy_dtype, na_value=dtype.type(0)), missing)
    raise TypeError(f"{name!r}: {dtype} cannot be kept exactly")


def _array(parts: tuple[Any, ...]) -> Any:
    match parts:
        case ("numpy", np.ndarray(ndim=1) as values):
            return values
        case ("objects", [*values]):
            return _objects(values)
        case ("categorical", np.ndarray(ndim=1) as codes, categories, bool(ordered)):
            dtype = pd.CategoricalDtype(_index(categories), ordered)
            return pd.Categorical.from_codes(codes, dtype=dtype)
        case ("text", [*texts], bool(with_na)):
            if not all(text is None or isinstance(text, str) for text in texts):
                raise ValueError("a text is not a str")
            return pd.array(texts, dtype=pd.StringDtype(na_value=pd.NA if with_na else np.nan))
        case (str(kind), np.ndarray(ndim=1) as values, np.ndarray(ndim=1) as missing):
            return _MASKED[kind](values.copy(), missing.copy())
    raise ValueError("these are not the parts of a column")


def _objects(values: Iterable[object]) -> NDArray[np.object_]:
    objects = list(values)
    array = np.empty(len(objects), dtype=object)
    for place, value in enumerate(objects):  # an assignment at once would look into tuples
        array[place] = value
    return array
