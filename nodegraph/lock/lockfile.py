"""The file of a lock: what a study concluded and from what, and the record of its run.

People read the conclusions, tables, versions, methods and graph. What only programs compare, a few
digests for each step, is the last key: JSON, compressed, as base64.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
import textwrap
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any
from zipfile import is_zipfile

import yaml
from pydantic import Field, ValidationError

from nodegraph.errors import NodegraphError
from nodegraph.execute.results import Run
from nodegraph.graphfile.reader import not_utf8
from nodegraph.lock.conclusions import reported_by
from nodegraph.lock.portable import FileNames, portable, refuse_paths, relative
from nodegraph.lock.results import Results
from nodegraph.lock.sketch import TOLERANCE
from nodegraph.runs.record import Cell, Record, RecordedStep
from nodegraph.validation_errors import adapter_of, first_error

FORMAT = 2
SUFFIX = ".lock"
_HEAD = """\
# What a study concluded, and what decided it. `nodegraph verify` checks it.
# It is written by `nodegraph lock`, and an edit by hand makes it useless.
nodegraph_lock: """
_FIRST = re.compile(r"(?:#.*\n)*nodegraph_lock: (.*)\n")
_END = "# end of the lock\n"
_CHECKSUM = re.compile(r"checksum: ([0-9a-f]{64})\n")
_MOST_BYTES = 200_000_000
_ENCODING = "utf-8-sig"
"""The encoding that also reads the byte order mark that some editors write."""
_WIDTH = 100
_LONG = 40
_READABLE = ("inputs", "axes", "removed", "versions")
"""Fields of the record that have a key of their own, as those of its settings have."""


_SETTINGS = ("graph", "set", "axis", "only")


@dataclass(frozen=True)
class Lock:
    """A frozen study.

    Attributes
    ----------
    conclusions : dict of reported value to list of str
    tables : dict of reported value to str
        As CSV.
    tolerance : float
        Relative size of differences that do not count.
    text : dict of file to str
        The graph file, and those that it includes.
    sizes : dict of node or alternative to (dict of place to float)
        Usual size of the floats at each place of its values.
    record : Record
        The record of the run that was locked; without the texts of included graphs.
    """

    conclusions: dict[str, list[str]]
    tables: dict[str, str]
    tolerance: Annotated[float, Field(gt=0, lt=1)]
    text: Annotated[dict[str, str], Field(min_length=1)]
    sizes: dict[str, dict[str, Annotated[float, Field(gt=0, allow_inf_nan=False)]]]
    record: Record

    def graph(self, path: Path) -> Path:
        """Return the graph file of a lock with this path, if it is still there."""
        return path.parent / self.record.settings.graph


def lock_of(run: Run, path: Path) -> Lock:
    """Return the lock of a run, to be written to `path`."""
    spec = run.plan.graph.spec
    file = Path(spec.file).name
    results, reported = Results(run), list(reported_by(run))
    record = portable(run, FileNames(run.plan.graph), results)
    sizes = results.usual_sizes(record.steps)
    graph = relative(spec.folder / file, path.parent)
    return Lock(
        conclusions={
            value.name: list(value.conclusions) for value in reported if value.conclusions
        },
        tables={value.name: value.table for value in reported},
        tolerance=TOLERANCE,
        text={file: spec.text, **spec.included},
        sizes=sizes,
        record=replace(
            record,
            settings=replace(record.settings, graph=graph),
            included={},
            title=spec.title or file,
            steps=[_locked(step, results, sizes) for step in record.steps],
        ),
    )


def _locked(
    step: RecordedStep, results: Results, sizes: Mapping[str, Mapping[str, float]]
) -> RecordedStep:
    """Return a step with the sketch of its values, without the key of its store."""
    sketch = results.sketch(step.step) if step.has_result else None
    text = sketch.text(sizes[step.cells[0].group]) if sketch else ""
    return replace(step, inputs={}, key="", sketch=text)


def lock_text(run: Run, path: Path) -> str:
    """Return the text of a lock of a run, to be written to `path`.

    Raises
    ------
    NodegraphError
        If it would contain an absolute path of this machine.
    """
    lock = lock_of(run, path)
    record = adapter_of(Record).dump_python(lock.record, mode="json", exclude_defaults=True)
    settings = record.pop("settings")
    head = {
        "title": record.pop("title"),
        "graph": settings.pop("graph"),
        "conclusions": lock.conclusions,
        "tables": lock.tables,
        "tolerance": lock.tolerance,
        **settings,
        **{name: record.pop(name, {}) for name in _READABLE},
        "files": lock.record.files(),
        "methods": dict(_methods(lock.record)),
        "text": lock.text,
    }
    head = {name: value for name, value in head.items() if value}
    content = json.dumps({"sizes": lock.sizes, **record}, separators=(",", ":"))
    refuse_paths(f"{_dump(head)}{content}", (run.plan.graph.spec.folder, Path.home()))
    packed = base64.b64encode(zlib.compress(content.encode(), 9)).decode()
    head["record"] = "".join(f"{line}\n" for line in textwrap.wrap(packed, _WIDTH - 2))
    body = f"{_dump(head)}{_END}"
    checksum = hashlib.sha256(body.encode()).hexdigest()
    return f"{_HEAD}{FORMAT}\nchecksum: {checksum}\n{body}"


def is_lock(path: Path) -> bool:
    """Return whether a file is a lock, even a damaged one or one of another format."""
    with path.open(encoding=_ENCODING, errors="replace") as file:
        return bool(_FIRST.match(file.read(len(_HEAD) + _WIDTH)))


def read_lock(path: Path) -> Lock:
    """Return the lock in a file.

    Raises
    ------
    NodegraphError
        If there is none, or if it was edited or written by another version.
    """
    text = _text(path)
    _check(path, text)
    try:
        data = yaml.load(text, yaml.CSafeLoader)
        packed = json.loads(_unpacked(data["record"]))
        packed |= {name: data.get(name, {}) for name in _READABLE}
        packed["title"] = data["title"]
        packed["settings"] = {name: data[name] for name in _SETTINGS if name in data}
        lock = {name: data.get(name, {}) for name in ("conclusions", "tables")}
        lock |= {name: data[name] for name in ("tolerance", "text")}
        lock |= {"sizes": packed.pop("sizes"), "record": packed}
        read: Lock = adapter_of(Lock).validate_python(lock)
    except ValidationError as error:
        raise NodegraphError(f"{path}: not a valid lock: {first_error(error, lock)}") from error
    except KeyError as error:
        raise NodegraphError(f"{path}: not a valid lock: {error.args[0]} is missing") from error
    except (yaml.YAMLError, zlib.error, ValueError, TypeError, AttributeError, RecursionError) as e:
        raise NodegraphError(f"{path}: not a valid lock: {e}") from e
    return read


def _methods(record: Record) -> Iterator[tuple[str, object]]:
    """Yield each method with what people want to know of it."""
    by_group: dict[str, list[tuple[Cell, RecordedStep]]] = {}
    for step in record.steps:
        for cell in step.cells:
            by_group.setdefault(cell.group, []).append((cell, step))
    for name, node in record.nodes.items():
        for label, method in node.methods.items():
            group = f"{name}={label}" if name in node.axes else name
            pairs = by_group.get(group, [])
            endings = Counter(step.ending for _, step in pairs)
            digests = "\n".join(digest for _, step in pairs for digest in step.digests)
            yield (
                group,
                {
                    "use": method.use,
                    "from": f"{method.plugin} of {method.distribution or 'a file'}",
                    "settings": _InLine(_settings(pairs)),
                    "results": ", ".join(f"{count} {how}" for how, count in endings.items()),
                    "digest": hashlib.sha256(digests.encode()).hexdigest()[:10],
                },
            )


def _settings(pairs: list[tuple[Cell, RecordedStep]]) -> Iterator[tuple[str, object]]:
    """Yield each setting with its value, or its values by the labels of an axis."""
    for name in pairs[0][1].settings if pairs else ():
        values = [step.settings.get(name) for _, step in pairs]
        if all(value == values[0] for value in values):
            yield name, values[0]
            continue
        for axis in pairs[0][0].labels:
            labels = [cell.labels[axis] for cell, _ in pairs]
            by_label = dict(zip(labels, values, strict=True))
            if [by_label[label] for label in labels] == values:
                yield name, f"${axis}" if list(by_label) == list(by_label.values()) else by_label
                break
        else:
            yield name, "of several axes"


class _InLine(dict[str, object]):
    """A mapping that is written without a line for each key."""


class _Dumper(yaml.SafeDumper):
    """Writes YAML for people: texts of several lines as they are, and short lists in a line."""

    def ignore_aliases(self, data: object) -> bool:
        return True


def _represent_text(dumper: _Dumper, text: str) -> yaml.Node:
    style = "|" if "\n" in text else None
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


def _represent_list(dumper: _Dumper, items: list[Any]) -> yaml.Node:
    long = any(isinstance(item, str) and len(item) > _LONG for item in items)
    return dumper.represent_sequence(
        "tag:yaml.org,2002:seq", items, flow_style=False if long else None
    )


def _represent_in_line(dumper: _Dumper, items: _InLine) -> yaml.Node:
    return dumper.represent_mapping("tag:yaml.org,2002:map", items.items(), flow_style=True)


_Dumper.add_representer(_InLine, _represent_in_line)
_Dumper.add_representer(str, _represent_text)
_Dumper.add_representer(list, _represent_list)


def _dump(data: object) -> str:
    # leaves in one line
    text: str = yaml.dump(
        data,
        Dumper=_Dumper,
        default_flow_style=None,
        sort_keys=False,
        allow_unicode=True,
        width=_WIDTH,
    )
    return text


def _unpacked(text: str) -> bytes:
    content = zlib.decompressobj().decompress(base64.b64decode(text), _MOST_BYTES + 1)
    if len(content) > _MOST_BYTES:
        raise ValueError("its record is too large")
    return content


def _text(path: Path) -> str:
    try:
        if path.exists() and not path.is_file():
            raise NodegraphError(f"{path}: not a regular file")
        if path.stat().st_size > _MOST_BYTES:
            raise NodegraphError(f"{path}: too large to be a lock")
        return path.read_text(encoding=_ENCODING)
    except FileNotFoundError:
        raise NodegraphError(f"{path}: no such file; `nodegraph lock GRAPH` writes one") from None
    except (OSError, ValueError) as error:
        reason = "cannot be read as a lock"
        if isinstance(error, UnicodeDecodeError):
            if is_zipfile(path):
                raise NodegraphError(
                    f"{path}: {reason}: it is an archive; unpack it, and name the lock in it"
                ) from None
            problem = not_utf8(path, error)
            raise NodegraphError(f"{problem.place}: {reason}: {problem.message}") from None
        raise NodegraphError(f"{path}: {reason}: {error}") from error


def _check(path: Path, text: str) -> None:
    """Raise an error if the text is not that of a lock of this format, as it was written."""
    first = _FIRST.match(text)
    if first is None:
        raise NodegraphError(f"{path}: this is not a lock; `nodegraph lock GRAPH` writes one")
    if first[1] != str(FORMAT):
        raise NodegraphError(
            f"{path}: the format of the lock is {first[1]}, and this version of nodegraph reads "
            f"{FORMAT}; write it again with `nodegraph lock`, or use the version that wrote it"
        )
    rest = text[first.end() :]
    match = _CHECKSUM.match(rest)
    body = rest[match.end() :] if match else ""
    if match is None or hashlib.sha256(body.encode()).hexdigest() != match[1]:
        if _END.strip() not in rest:
            raise NodegraphError(f"{path}: the lock is truncated; get the whole file or lock again")
        raise NodegraphError(
            f"{path}: the lock was edited (its checksum does not match); get the original file, "
            "or lock again"
        )
