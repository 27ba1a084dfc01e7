"""The forms of an axis: a list, labels with values, or a generator."""

from __future__ import annotations

import math
import re
from fnmatch import translate
from glob import iglob
from itertools import islice
from pathlib import Path, PurePath

from nodegraph.errors import Place, Problems, quoted
from nodegraph.graphfile.keys import AXIS_HINT, IDENTIFIER, MOST_LABELS
from nodegraph.graphfile.spec import AxisSpec
from nodegraph.graphfile.yaml_text import Located, located
from nodegraph.node.ports import Label

FILE = "file"
"""The field that stands for a whole value: ``$recording`` is that of the label."""
_FIELD = re.compile(r"\{([^{}]*)\}")

_Entries = list[tuple[Label, object, Place]]
"""Labels, the value behind each, and where it was written."""


def read_axis(name: str, item: Located, folder: Path, problems: Problems) -> AxisSpec:
    """Return the axis that a value describes, without labels if it describes none.

    Parameters
    ----------
    name
    item
        A list, labels with values, or a generator.
    folder
        Where patterns of files start.
    problems
    """
    entries = _entries(item, folder, problems)
    if entries == []:
        problems.add(item.place, f"axis {quoted(name)} has no label", AXIS_HINT)
    if not entries:
        return AxisSpec(name, item.place, (), ())
    _refuse_repeats(name, entries, problems)
    labels, values, _ = zip(*entries, strict=True)
    return AxisSpec(name, item.place, labels, values)


def axis_from_option(name: str, value: object, folder: Path, problems: Problems) -> AxisSpec:
    """Return the axis that a command or a caller describes by plain data; see `read_axis`."""
    place = Place(f"--axis {name}")
    if isinstance(value, (list, tuple, range)) and value[MOST_LABELS : MOST_LABELS + 1]:
        problems.add(place, f"axis {quoted(name)} has more than {MOST_LABELS:,} labels")
        return AxisSpec(name, place, (), ())
    return read_axis(name, located(value, place), folder, problems)


def is_pattern(value: object) -> bool:
    """Return whether plain data describe an axis by a pattern of files."""
    return isinstance(value, dict) and list(value) == ["files"]


def is_label(value: object) -> bool:
    """Return whether a value can be a label: a word, a number or a boolean."""
    return isinstance(value, (str, int, float)) and value == value and value != ""


def _entries(item: Located, folder: Path, problems: Problems) -> _Entries | None:
    if isinstance(item.value, list):
        return _from_list(item.value, problems)
    if isinstance(item.value, dict):
        generator = next(iter(item.value)) if len(item.value) == 1 else None
        if generator == "count":
            return _from_count(item.value["count"], problems)
        if generator == "range":
            return _from_range(item.value["range"], problems)
        if generator == "files":
            return _from_files(item.value["files"], folder, problems)
        return _from_labels(item, problems)
    problems.add(item.place, f"an axis cannot be {quoted(item.value)}", AXIS_HINT)
    return None


def _from_list(items: list[Located], problems: Problems) -> _Entries | None:
    wrong = [item for item in items if not is_label(item.value)]
    for item in wrong:
        hint = "give such values labels: {label: value, ...}"
        problems.add(item.place, "a label must be a word, a number or a boolean", hint)
    return None if wrong else [(item.value, item.value, item.place) for item in items]


def _from_labels(item: Located, problems: Problems) -> _Entries | None:
    wrong = [key for key in item.value if not is_label(key)]
    for key in wrong:
        problems.add(item.keys[key], f"{quoted(key)} cannot be a label", AXIS_HINT)
    if wrong:
        return None
    return [(key, value.plain(), item.keys[key]) for key, value in item.value.items()]


def _from_count(item: Located, problems: Problems) -> _Entries | None:
    count = item.value
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_LABELS:
        problems.add(item.place, f"count must be a whole number from 1 to {MOST_LABELS:,}")
        return None
    return [(index, index, item.place) for index in range(count)]


def _from_range(item: Located, problems: Problems) -> _Entries | None:
    bounds = item.plain()
    if not _is_range(bounds):
        problems.add(item.place, "range must be [first, last, step] with a step towards the last")
        return None
    first, last, step = bounds
    try:
        count = math.floor((last - first) / step + 1e-9) + 1
    except OverflowError:
        count = MOST_LABELS + 1
    if count > MOST_LABELS:
        problems.add(item.place, f"range has more than {MOST_LABELS:,} labels")
        return None
    return [(value, value, item.place) for value in (first + i * step for i in range(count))]


def _from_files(item: Located, folder: Path, problems: Problems) -> _Entries | None:
    """Return a label for each file: its name without the suffix, or the fields of the pattern.

    With fields, ``{actor}_{take}.c3d``, the value is a mapping of these and of the file.
    """
    pattern = item.value
    if not isinstance(pattern, str) or not pattern:
        problems.add(item.place, 'files must be a pattern, such as {files: "data/*.csv"}')
        return None
    fields = _FIELD.findall(pattern)
    wrong = [name for name in fields if not re.fullmatch(IDENTIFIER, name) or name == FILE]
    if wrong or len(set(fields)) < len(fields):
        name = wrong[0] if wrong else max(fields, key=fields.count)
        message = f"files: {{{name}}} {'cannot be a field' if wrong else 'stands twice'}"
        problems.add(item.place, message, 'write names: {files: "data/{actor}_{take}.c3d"}')
        return None
    entries: dict[str, tuple[str, object]] = {}
    for name in _matches(item, pattern, folder, problems):
        match = re.fullmatch(_expression(pattern), name) if fields else None
        of = match.groupdict() if match else {}
        label, value = "_".join(of.values()) or PurePath(name).stem, {FILE: name, **of}
        first, _ = entries.setdefault(label, (name, value if of else name))
        if first != name:
            message = f"{first} and {name} would have one label"
            problems.add(item.place, message, "narrow the pattern, or write {label: file, ...}")
            return None
    return [(label, value, item.place) for label, (_, value) in entries.items()] or None


def _matches(item: Located, pattern: str, folder: Path, problems: Problems) -> list[str]:
    """Return the files that match a pattern, in order; none where that is a problem."""
    try:
        # relative to the folder, as the settings that name the files are
        matches = iglob(_FIELD.sub("?*", pattern), root_dir=folder, recursive=True)
        names = sorted(PurePath(name).as_posix() for name in islice(matches, MOST_LABELS + 1))
    except (OSError, ValueError) as error:
        problems.add(item.place, f"files: {quoted(pattern)} cannot be searched: {error}")
        return []
    if not names:
        hint = f"the folder is {(folder / pattern).parent}"
        problems.add(item.place, f"no file matches {quoted(pattern)}", hint)
    if len(names) > MOST_LABELS:
        problems.add(item.place, f"more than {MOST_LABELS:,} files match {quoted(pattern)}")
        return []
    return names


def _expression(pattern: str) -> str:
    """Return the regular expression of a pattern: a field is long, and no more than one folder."""
    parts = _FIELD.split(PurePath(pattern).as_posix())
    plain = [
        "(?:.*/)?".join(translate(piece)[len("(?s:") : -len(r")\Z")] for piece in part.split("**/"))
        for part in parts[::2]
    ]
    named = [f"(?P<{name}>[^/]+)" for name in parts[1::2]]
    return plain[0] + "".join(map("".join, zip(named, plain[1:], strict=True)))


def _is_range(bounds: object) -> bool:
    if not isinstance(bounds, list) or len(bounds) != 3 or not all(map(_is_finite, bounds)):
        return False
    first, last, step = bounds
    return bool(step and (first <= last if step > 0 else first >= last))


def _is_finite(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < math.inf


def _refuse_repeats(name: str, entries: _Entries, problems: Problems) -> None:
    seen: set[Label] = set()
    for label, _, place in entries:
        if label in seen:
            problems.add(place, f"axis {quoted(name)} has the label {quoted(label)} twice")
        seen.add(label)
