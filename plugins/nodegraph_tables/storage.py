"""How tables and figures are kept: a table exactly or not at all, a figure as its drawing."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd

from nodegraph import Storage
from nodegraph_tables.stored_figure import StoredFigure
from nodegraph_tables.types import Figure, Table


def storages() -> tuple[Storage, ...]:
    """Return the storages of the types that are not this package's own classes."""
    return (
        Storage(Table, table_apart, table_together, lend=lent_table),
        Storage(Figure, figure_apart, figure_together, faithful=False),
    )


def table_apart(table: Table) -> dict[str, Any]:
    """Return what a table is made of; see `nodegraph_tables.storage`."""
    return take_apart(table)


def table_together(parts: dict[str, Any]) -> Table:
    """Return the table again."""
    return put_together(parts)


def lent_table(table: Table) -> Table:
    """Return a copy that a reader may write to, its columns in memory one after the other.

    A table that was just computed may lie in memory in other ways than one from the store. The
    sums of its columns would then differ in their last bit.
    """
    return table.copy(deep=True)


def figure_apart(figure: Figure) -> tuple[bytes, bytes]:
    """Return the drawing of a figure as SVG and PDF."""
    from nodegraph_tables.renderers import saved

    return saved(figure, "svg"), saved(figure, "pdf")


def figure_together(drawing: tuple[bytes, bytes]) -> StoredFigure:
    """Return the drawing, which stands in for the figure wherever it is only shown."""
    return StoredFigure(*drawing)


_MASKED: dict[str, Any] = {
    "integer": pd.arrays.IntegerArray,
    "floating": pd.arrays.FloatingArray,
    "boolean": pd.arrays.BooleanArray,
}
_INDICES = (pd.Index, pd.DatetimeIndex, pd.TimedeltaIndex, pd.CategoricalIndex)
_MOST_COUNTED = 2**26
"""Rows that are counted, and so take no bytes until somebody looks at them."""


def take_apart(table: pd.DataFrame) -> dict[str, Any]:
    """Return what a table is made of.

    Raises
    ------
    TypeError
        If some of it could not be put together exactly.
    """
    if type(table) is not pd.DataFrame:
        raise TypeError(f"{type(table).__name__} is more than a DataFrame")
    places = range(table.shape[1])
    return {
        "columns": _index_apart(table.columns),
        "index": _index_apart(table.index),
        "data": [_apart(table.iloc[:, place], table.columns[place]) for place in places],
        "attrs": table.attrs,
        "unique": not table.flags.allows_duplicate_labels,
    }


def put_together(parts: dict[str, Any]) -> pd.DataFrame:
    """Return the table again.

    Raises
    ------
    ValueError
        If these are not the parts of a table.
    """
    index = _index_together(parts["index"])
    data = [_together(one) for one in parts["data"]]
    if any(one.shape != (len(index),) for one in data):
        raise ValueError("a column is not as long as the index")
    columns = {
        place: pd.Series(one, index=index, dtype=one.dtype) for place, one in enumerate(data)
    }
    table = pd.DataFrame(columns, index=index)
    table.columns = _index_together(parts["columns"])
    table.attrs = parts["attrs"]
    return table.set_flags(allows_duplicate_labels=not parts["unique"])


def _index_apart(index: pd.Index[Any]) -> tuple[Any, ...]:
    if type(index) is pd.RangeIndex:
        _counted(index)
        return ("range", index.start, index.stop, index.step, index.name)
    if type(index) is pd.MultiIndex:
        levels = [_index_apart(level) for level in index.levels]
        codes = [np.asarray(one) for one in index.codes]
        return ("multi", levels, codes, list(index.names))
    if type(index) not in _INDICES or getattr(index, "freq", None) is not None:
        raise TypeError(f"the index, a {type(index).__name__}, cannot be kept exactly")
    return ("index", _apart(index, "index"), index.name)


def _index_together(parts: tuple[Any, ...]) -> pd.Index[Any]:
    match parts:
        case ("range", int(start), int(stop), int(step), name):
            return _counted(pd.RangeIndex(start, stop, step, name=name))
        case ("multi", [*levels], [*codes], [*names]):
            return _multi_index([_index_together(level) for level in levels], codes, names)
        case ("index", held, name):
            array = _together(held)
            index: pd.Index[Any] = pd.Index(array, dtype=array.dtype, name=name)
            return index
    raise ValueError("no parts of an index")


def _counted(index: pd.RangeIndex) -> pd.RangeIndex:
    if len(index) > _MOST_COUNTED:
        raise ValueError(f"an index counts {len(index)} rows")
    return index


def _multi_index(levels: Any, codes: list[Any], names: list[Any]) -> pd.MultiIndex:
    for level, code in zip(levels, codes, strict=True):
        # pandas itself looks a code up without looking whether it is there
        if code.dtype.kind != "i" or code.shape != (len(codes[0]),):
            raise ValueError("no codes of an index on levels")
        if isinstance(level, pd.MultiIndex):
            raise ValueError("a level has levels")
        if len(code) and not -1 <= code.min() <= code.max() < len(level):
            raise ValueError("a code has no place on its level")
    return pd.MultiIndex(levels=levels, codes=codes, names=names, verify_integrity=False)


def _apart(held: pd.Series[Any] | pd.Index[Any], where: Any) -> tuple[Any, ...]:
    """Return what one column, or an index, is made of."""
    kind: Any = held.dtype
    array: Any = held.array
    if isinstance(kind, np.dtype):
        values = held.to_numpy()
        return ("objects", list(values)) if kind.kind == "O" else ("numpy", values.copy())
    if isinstance(kind, pd.CategoricalDtype):
        return ("categorical", array.codes, _index_apart(kind.categories), kind.ordered)
    if isinstance(kind, pd.StringDtype):
        texts = [
            None if missing else text for text, missing in zip(array, array.isna(), strict=True)
        ]
        return ("text", texts, kind.storage, kind.na_value is pd.NA)
    for name, masked in _MASKED.items():
        if type(array) is masked:
            missing = array.isna()
            return (name, array.to_numpy(kind.numpy_dtype, na_value=kind.type(0)), missing)
    raise TypeError(f"{where!r}: {kind} cannot be kept exactly")


def _together(parts: tuple[Any, ...]) -> Any:
    match parts:
        case ("numpy", np.ndarray(ndim=1) as values):
            return values
        case ("objects", [*values]):
            return _objects(values)
        case ("categorical", np.ndarray(ndim=1) as codes, categories, bool(ordered)):
            known = pd.CategoricalDtype(_index_together(categories), ordered)
            return pd.Categorical.from_codes(codes, dtype=known)
        case ("text", [*texts], storage, bool(with_na)):
            if not all(text is None or isinstance(text, str) for text in texts):
                raise ValueError("a text is none")
            return pd.array(texts, dtype=pd.StringDtype(storage, pd.NA if with_na else np.nan))
        case (str(kind), np.ndarray(ndim=1) as values, np.ndarray(ndim=1) as missing):
            return _MASKED[kind](values.copy(), missing.copy())
    raise ValueError("no parts of a column")


def _objects(values: Iterable[Any]) -> np.ndarray[Any, np.dtype[np.object_]]:
    listed = list(values)
    array = np.empty(len(listed), dtype=object)
    for place, value in enumerate(listed):  # an assignment at once would look into tuples
        array[place] = value
    return array
