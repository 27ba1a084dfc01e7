"""Compare any two values part by part; NaN equals NaN."""

from __future__ import annotations

import io
import pickle
import sys
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_DOTS_PER_INCH = 50
_PLAIN = frozenset({bool, int, float, complex, str, bytes})


def same(first: object, second: object) -> bool:
    """Return whether two values are equal in every part; NaN equals NaN.

    Compares the parts of dataclasses, named tuples, sequences, mappings, arrays and pandas
    tables, and the pixels of matplotlib figures. Types, shapes and dtypes count.
    """
    return not difference(first, second)


def difference(first: object, second: object, *, name: str = "value") -> str:
    """Return where two values first differ and how, or an empty text if they are equal.

    Parameters
    ----------
    first, second
        As for `same`.
    name
        The value's name in the text.

    Examples
    --------
    >>> difference({"rate": [60, 120]}, {"rate": [60, 100]}, name="take")
    "take['rate'][1]: 120 and 100"
    """
    found = _difference(first, second, name, set())
    return found if isinstance(found, str) else f"{found[0]}: {' and '.join(found[1:3])}{found[3]}"


def change(was: object, now: object, *, name: str = "value") -> str:
    """Return where a value first changed and how: ``rate was 60, now 30``; else an empty text.

    Parameters
    ----------
    was, now
        As for `same`.
    name
        The value's name in the text.
    """
    found = _difference(was, now, name, set())
    if isinstance(found, str):
        return found
    at, before, after, more = found
    return f"{at} was {before}, now {after}{more}"


_Found = str | tuple[str, str, str, str]
"""Place, both values and a remark; or a sentence, empty where nothing differs."""


def _difference(first: Any, second: Any, at: str, seen: set[tuple[int, int]]) -> _Found:
    if first is second:
        return ""
    if type(first) is not type(second):
        return at, type(first).__name__, type(second).__name__, ""
    if (id(first), id(second)) in seen or _are_plainly_equal(first, second):
        return ""
    if isinstance(first, np.ndarray) and not first.dtype.hasobject:
        return _array_difference(first, second, at)
    parts = _parts(first)
    if parts is None:
        return "" if _equal(first, second) else (at, _short(first), _short(second), "")
    seen.add((id(first), id(second)))
    second_parts = _parts(second) or {}
    if parts.keys() != second_parts.keys():
        odd = ", ".join(sorted(f"{at}{name}" for name in parts.keys() ^ second_parts.keys()))
        return f"only one of them has {odd}"
    for name, part in parts.items():
        if part is not second_parts[name]:
            found = _difference(part, second_parts[name], f"{at}{name}", seen)
            if found:
                return found
    return ""


def _are_plainly_equal(first: Any, second: Any) -> bool:
    """Return whether it is certain, without a look at their parts, that two values are equal."""
    if type(first) in (list, tuple):  # such as many names
        kinds = [*map(type, first)]
        return _PLAIN.issuperset(kinds) and kinds == [*map(type, second)] and first == second
    if not _is_figure(first):
        return type(first) in _PLAIN and first == second
    try:
        return _pickled(first) == _pickled(second)
    except Exception:  # what cannot be pickled, such as a local function, can be drawn
        return False


def _parts(value: object) -> Mapping[str, object] | None:
    """Return the parts of a value by the expressions that reach them; None if it has none."""
    if is_dataclass(value) and not isinstance(value, type):
        return {f".{field.name}": getattr(value, field.name) for field in fields(value)}
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {f".{name}": getattr(value, name) for name in value._fields}
    if isinstance(value, Mapping):
        return {f"[{key!r}]": part for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return {f"[{index}]": part for index, part in enumerate(value)}
    if isinstance(value, np.ndarray):
        return {".shape": value.shape, ".tolist()": value.tolist()}
    return _library_parts(value)


def _library_parts(value: Any) -> Mapping[str, object] | None:
    # by name, so that pandas is not imported for values of other types
    kinds = {f"{kind.__module__.partition('.')[0]}.{kind.__name__}" for kind in type(value).mro()}
    if "pandas.DataFrame" in kinds:
        columns = {f"[{name!r}]": value.iloc[:, i] for i, name in enumerate(value.columns)}
        metadata = {f".{name}": getattr(value, name, None) for name in value._metadata}
        return {".columns": tuple(value.columns), **columns, ".attrs": value.attrs, **metadata}
    if "pandas.Series" in kinds:
        return {".index": value.index.to_numpy(), ".values": value.to_numpy()}
    if _is_figure(value):
        return {".pixels": _pixels(value)}
    equals: object = type(value).__eq__
    if equals is object.__eq__ and hasattr(value, "__dict__"):
        return {f".{name}": part for name, part in vars(value).items()}
    return None


def _is_figure(value: object) -> bool:
    return isinstance(value, getattr(sys.modules.get("matplotlib.figure"), "Figure", ()))


def _pickled(figure: object) -> bytes:
    from matplotlib.transforms import TransformNode

    class Pickler(pickle.Pickler):
        def reducer_override(self, value: Any) -> Any:
            if not isinstance(value, TransformNode):
                return NotImplemented
            reduced: Any = value.__reduce_ex__(pickle.HIGHEST_PROTOCOL)
            make, arguments, state, *rest = reduced
            # the keys are the ids of its parents, which differ
            return make, arguments, {**state, "_parents": [*state["_parents"].values()]}, *rest

    written = io.BytesIO()
    Pickler(written, pickle.HIGHEST_PROTOCOL).dump(figure)
    return written.getvalue()


def _pixels(figure: Any) -> NDArray[np.generic]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    # to save it would draw it twice if something lays it out
    canvas, dpi = figure.canvas, figure.dpi
    try:
        figure.dpi = _DOTS_PER_INCH
        drawn: Any = FigureCanvasAgg(figure)
        drawn.draw()
        return np.array(drawn.buffer_rgba())
    finally:
        figure.dpi = dpi
        figure.set_canvas(canvas)


def _array_difference(first: NDArray[np.generic], second: NDArray[np.generic], at: str) -> _Found:
    if first.dtype != second.dtype or first.shape != second.shape:
        return at, f"{first.dtype} {first.shape}", f"{second.dtype} {second.shape}", ""
    differs = first != second
    if first.dtype.kind in "fcmM":
        differs &= ~(np.isnan(first) & np.isnan(second))
    if not differs.any():
        return ""
    index = tuple(map(int, np.argwhere(differs)[0]))
    subscript = f"[{', '.join(map(str, index))}]" if index else ""
    count = np.count_nonzero(differs)
    more = f" ({count} such places)" if count > 1 else ""
    return f"{at}{subscript}", str(first[index]), str(second[index]), more


def _equal(first: object, second: object) -> bool:
    both_nan = isinstance(first, (float, complex)) and first != first and second != second
    return both_nan or bool(first == second)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
