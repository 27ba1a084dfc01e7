"""The forms of an axis: a list, labels with values, or a generator."""

from __future__ import annotations

import math
from typing import Any

from nodegraph.errors import Place, Problems
from nodegraph.graphfile.spec import AxisSpec
from nodegraph.graphfile.yaml_text import Located, located
from nodegraph.node.ports import Label

_MOST_LABELS = 1_000_000
FORMS = "write a list [5, 15], labels {a: 5, b: 15}, {count: 20} or {range: [5, 60, 5]}"


def read_axis(name: str, item: Located, problems: Problems) -> AxisSpec:
    """Return the axis that a value describes, without labels when it describes none."""
    pairs = _pairs(item, problems)
    if pairs == []:
        problems.add(item.place, f"axis {name!r} has no label", FORMS)
    if not pairs:
        return AxisSpec(name, item.place, (), ())
    _refuse_repeats(name, pairs, problems)
    labels, values, _ = zip(*pairs, strict=True)
    return AxisSpec(name, item.place, labels, values)


def read_given_axis(name: str, value: Any, problems: Problems) -> AxisSpec:
    """Return the axis that a command or a caller gives."""
    place = Place(f"--axis {name}")
    if isinstance(value, (list, tuple, range)) and value[_MOST_LABELS : _MOST_LABELS + 1]:
        problems.add(place, f"axis {name!r} has more than {_MOST_LABELS:,} labels")
        return AxisSpec(name, place, (), ())
    return read_axis(name, located(value, place), problems)


def is_label(value: object) -> bool:
    """Whether a value can be a label: a word, a number or a boolean."""
    return isinstance(value, (str, int, float)) and value == value and value != ""


def _pairs(item: Located, problems: Problems) -> list[tuple[Label, Any, Place]] | None:
    if isinstance(item.value, list):
        return _from_list(item.value, problems)
    if isinstance(item.value, dict):
        generator = next(iter(item.value)) if len(item.value) == 1 else None
        if generator == "count":
            return _from_count(item.value["count"], problems)
        if generator == "range":
            return _from_range(item.value["range"], problems)
        return _from_labels(item, problems)
    problems.add(item.place, f"an axis cannot be {item.value!r}", FORMS)
    return None


def _from_list(items: list[Located], problems: Problems) -> list[tuple[Label, Any, Place]] | None:
    bad = [one for one in items if not is_label(one.value)]
    for one in bad:
        instead = "give such values labels: {label: value, ...}"
        problems.add(one.place, "a label must be a word, a number or a boolean", instead)
    return None if bad else [(one.value, one.value, one.place) for one in items]


def _from_labels(item: Located, problems: Problems) -> list[tuple[Label, Any, Place]] | None:
    bad = [key for key in item.value if not is_label(key)]
    for key in bad:
        problems.add(item.keys[key], f"{key!r} cannot be a label", FORMS)
    return None if bad else [(key, one.plain(), item.keys[key]) for key, one in item.value.items()]


def _from_count(item: Located, problems: Problems) -> list[tuple[Label, Any, Place]] | None:
    count = item.value
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= _MOST_LABELS:
        problems.add(item.place, f"count must be a whole number from 1 to {_MOST_LABELS:,}")
        return None
    return [(index, index, item.place) for index in range(count)]


def _from_range(item: Located, problems: Problems) -> list[tuple[Label, Any, Place]] | None:
    bounds = item.plain()
    if not _is_range(bounds):
        problems.add(item.place, "range must be [first, last, step] with a step towards the last")
        return None
    first, last, step = bounds
    count = _count(first, last, step)
    if count is None:
        problems.add(item.place, f"range has more than {_MOST_LABELS:,} labels")
        return None
    return [(value, value, item.place) for value in (first + i * step for i in range(count))]


def _is_range(bounds: Any) -> bool:
    if not isinstance(bounds, list) or len(bounds) != 3 or not all(map(_is_finite, bounds)):
        return False
    first, last, step = bounds
    return bool(step and (first <= last if step > 0 else first >= last))


def _is_finite(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < math.inf


def _count(first: float, last: float, step: float) -> int | None:
    """Return how many values a range has, or None for too many."""
    try:
        count = math.floor((last - first) / step + 1e-9) + 1
    except OverflowError:
        return None
    return count if count <= _MOST_LABELS else None


def _refuse_repeats(name: str, pairs: list[tuple[Label, Any, Place]], problems: Problems) -> None:
    seen: set[Label] = set()
    for label, _, place in pairs:
        if label in seen:
            problems.add(place, f"axis {name!r} has the label {label!r} twice")
        seen.add(label)
