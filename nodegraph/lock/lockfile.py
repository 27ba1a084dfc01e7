"""A frozen study: everything that decided its results, and what they were, in a small text file."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from nodegraph.errors import NodegraphError
from nodegraph.execute import Run
from nodegraph.graphfile.yaml_text import read_yaml, scalar
from nodegraph.lock.provenance import FileNames, account, refuse_paths, relative
from nodegraph.lock.results import Recorded, Results, cells_of, recorded, said_by, scales
from nodegraph.lock.sketch import TOLERANCE, Parts
from nodegraph.validation import first_error

_Name = Annotated[str, Field(min_length=1)]
_Label = str | int | float | bool
# a name of digits alone is read as a number where it is a key
_Texts = dict[_Label, str]
_Size = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class _Part(BaseModel):
    model_config = ConfigDict(strict=True)


class _Versions(_Part):
    model_config = ConfigDict(strict=True, extra="allow")
    __pydantic_extra__: dict[str, str]

    python: str


class _Choices(_Part):
    inputs: dict[str, Any] = Field({}, alias="set")
    axis: dict[str, Any] = {}
    only: dict[str, list[_Label]] = {}


class _Method(_Part):
    use: _Name
    plugin: _Name | None = None
    distribution: str = Field("", alias="from")
    code: str = ""
    axes: list[str] = []
    gathers: list[str] = []
    fed: dict[str, Any] = Field({}, alias="in")
    settings: dict[str, Any] = {}


class _Results(_Part):
    along: list[str] = []
    scale: dict[str, _Size] = {}
    steps: _Texts


class _Data(_Part):
    graph: _Name
    title: str
    tolerance: Annotated[float, Field(gt=0, lt=1)]
    choices: _Choices
    versions: _Versions
    inputs: dict[str, Any]
    axes: dict[str, list[_Label] | dict[_Label, Any]]
    removed: dict[str, list[_Label]]
    files: _Texts
    methods: dict[str, _Method]
    code: _Texts
    conclusions: dict[str, list[str]]
    tables: dict[str, str]
    results: dict[str, _Results]
    parts: dict[str, dict[str, _Texts]]
    text: Annotated[dict[_Name, str], Field(min_length=1)]


def misfit(data: Any) -> str:
    """Return which key of a lock's data is first of another form than it is written in, and how.

    Parameters
    ----------
    data
        As read from YAML.

    Returns
    -------
    str
        ``methods.fill=linear.use: input should be a valid string``; empty if all is well.
    """
    try:
        _Data.model_validate(data)
    except ValidationError as error:
        return first_error(error, data)
    return ""


_INDENT = "  "
_LONG = 40
_UNSEEN = r"\x7f-\x9f\u2028\u2029\ud800-\udfff\ufeff\ufffe\uffff"
_WHOLE = re.compile(r"0|-?[1-9][0-9]{0,17}")
_BARE = re.compile(
    r"[A-Za-z0-9_$./(<+-](?:[ $()*+,./0-9;<=>?A-Z^_a-z~-]|:(?=[A-Za-z0-9_$./(<+-]))*"
)
_SEEN = rf"[^\x00-\x20{_UNSEEN}]"
_BLOCK = re.compile(rf"{_SEEN}(?:[^\x00-\x08\x0b-\x1f{_UNSEEN}]*{_SEEN})?\n")
_ESCAPED = re.compile(f"[{_UNSEEN}]")


def yaml_lines(data: Mapping[str, Any], depth: int = 0) -> Iterator[str]:
    """Yield the lines of a mapping of texts, numbers, truths, nothing, lists and such mappings."""
    indent = _INDENT * depth
    for key, value in data.items():
        head = f"{indent}{key if _WHOLE.fullmatch(key) else _yaml_lines_text(key)}:"
        if isinstance(value, Mapping) and value:
            yield head
            yield from yaml_lines(value, depth + 1)
        elif isinstance(value, (list, tuple)) and any(map(_is_long, value)):
            yield head
            yield from (f"{indent}{_INDENT}- {_flow(one)}" for one in value)
        elif isinstance(value, str) and _BLOCK.fullmatch(value):
            yield f"{head} |"
            lines = value.removesuffix("\n").split("\n")
            yield from (f"{indent}{_INDENT}{line}" if line else "" for line in lines)
        else:
            yield f"{head} {_flow(value)}"


def _is_long(value: Any) -> bool:
    return len(value) > _LONG if isinstance(value, str) else isinstance(value, (list, Mapping))


def _flow(value: Any) -> str:
    """Return a value in one line."""
    if isinstance(value, Mapping):
        pairs = (f"{_inside(str(key))}: {_inside(one)}" for key, one in value.items())
        return f"{{{', '.join(pairs)}}}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_inside, value))}]"
    return _scalar(value)


def _inside(value: Any) -> str:
    return _quoted(value) if isinstance(value, str) and "," in value else _flow(value)


def _scalar(value: Any) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else f"{'-' if value < 0 else ''}.inf"
    return _yaml_lines_text(value) if isinstance(value, str) else repr(value)


def _yaml_lines_text(text: str) -> str:
    bare = _BARE.fullmatch(text) and not re.match(r"-+( |$)|---", text) and text[-1] != " "
    return text if bare and isinstance(scalar(text), str) else _quoted(text)


def _quoted(text: str) -> str:
    said = json.dumps(text, ensure_ascii=False)
    return _ESCAPED.sub(lambda found: f"\\u{ord(found[0]):04x}", said)


FORMAT = 1
SUFFIX = ".lock"
_KEY = "nodegraph_lock"
_HEAD = f"""\
# What decided the results of a study, and what they were. `nodegraph verify` checks it.
# It is written by `nodegraph lock`, and an edit by hand makes it useless.
{_KEY}: """
_END = "# end of the lock\n"
_SUM = re.compile(r"checksum: ([0-9a-f]{64})\n")
_NOT_OURS = "this is no lock as this program writes them"
_MOST_BYTES = 200_000_000
_ENCODING = "utf-8-sig"
"""Editors set a mark before the text, which is none of it."""
_Read = TypeVar("_Read")


@dataclass(frozen=True)
class Lock:
    """A lock that was read.

    Attributes
    ----------
    path : Path
    graph : Path
        Where the graph file lies, if it still does.
    data : mapping
        All of it, as it stands in the file.
    results : mapping of group to (mapping of labels to Recorded)
    scales : mapping of group to (mapping of place to float)
    parts : mapping of group to (mapping of place to (mapping of labels to Parts))
    """

    path: Path
    graph: Path
    data: Mapping[str, Any]
    results: Mapping[str, Mapping[str, Recorded]]
    scales: Mapping[str, Mapping[str, float]]
    parts: Mapping[str, Mapping[str, Mapping[str, Parts]]]


def lock_text(run: Run, path: Path) -> str:
    """Return the text of a lock of a run, to be written to `path`.

    Raises
    ------
    NodegraphError
        If it would hold a path of this machine.
    """
    spec = run.plan.graph.spec
    names = FileNames(run.plan.graph)
    graph_file = spec.folder / Path(spec.file).name
    said, results = list(said_by(run)), Results(run)
    data = {
        "graph": relative(graph_file, path.parent),
        "title": spec.title or Path(spec.file).name,
        "tolerance": TOLERANCE,
        "choices": _choices(run, names),
        **account(run, names),
        "conclusions": {one.name: list(one.sentences) for one in said if one.sentences},
        "tables": {one.name: one.numbers for one in said},
        "results": _results(run, results),
        "parts": _parts(run, results),
        "text": {Path(spec.file).name: spec.text, **spec.included},
    }
    body = "".join(f"{line}\n" for line in yaml_lines(data)) + _END
    refuse_paths(body, (spec.folder, Path.home()))
    checksum = hashlib.sha256(body.encode()).hexdigest()
    return f"{_HEAD}{FORMAT}\nchecksum: {checksum}\n{body}"


def is_lock(path: Path) -> bool:
    """Return whether a file is a lock, be it damaged or of another version."""
    with path.open(encoding=_ENCODING, errors="replace") as file:
        return file.read(len(_HEAD)) == _HEAD


def read_lock(path: Path) -> Lock:
    """Return what a lock holds.

    Raises
    ------
    NodegraphError
        If there is none, or it is not as it was written, or another version has written it.
    """
    data = _checked(path, _text(path))
    results, parts = data["results"], data["parts"]
    return Lock(
        path,
        path.parent / data["graph"],
        data,
        {
            group: _each(path, f"results.{group}.steps", one["steps"], Recorded.read)
            for group, one in results.items()
        },
        {group: one.get("scale", {}) for group, one in results.items()},
        {
            group: {
                place: _each(path, f"parts.{group}.{place}", lines, Parts.read)
                for place, lines in places.items()
            }
            for group, places in parts.items()
        },
    )


def _each(
    path: Path, at: str, lines: Mapping[Any, str], read: Callable[[str], _Read]
) -> dict[str, _Read]:
    """Return what each line says, by labels."""
    found: dict[str, _Read] = {}
    for labels, line in lines.items():
        try:
            found[str(labels)] = read(line)
        except ValueError as error:
            raise NodegraphError(f"{path}: {_NOT_OURS}: {at}.{labels}: {error}") from error
    return found


def _results(run: Run, results: Results) -> dict[str, Any]:
    cells = list(cells_of(run))
    usual = scales(cells, results, run)
    found: dict[str, Any] = {}
    for cell in cells:
        scale = usual.get(cell.group, {})
        axes = [axis for axis in cell.labels if axis != cell.node]
        group = found.setdefault(
            cell.group,
            {
                **({"along": axes} if axes else {}),
                **({"scale": scale} if scale else {}),
                "steps": {},
            },
        )
        group["steps"][cell.at] = recorded(cell, results, scale).text
    return found


def _parts(run: Run, results: Results) -> dict[str, Any]:
    """Return by groups and places what tells where in an array another one differs."""
    cells = [cell for cell in cells_of(run) if not results.ended(cell.index)]
    most = results.most_parts(cells)
    found: dict[str, dict[str, dict[str, str]]] = {}
    for cell in cells:
        for place, (parts, _) in results.parts(cell.index, most).items():
            found.setdefault(cell.group, {}).setdefault(place, {})[cell.at] = parts.text
    return found


def _choices(run: Run, names: FileNames) -> dict[str, Any]:
    chosen = run.plan.graph.choices
    axes = {name: _axis(one, names) for name, one in chosen.axes.items()}
    parts = {
        "set": names.portable(chosen.inputs),
        "axis": axes,
        "only": {name: list(labels) for name, labels in chosen.only.items()},
    }
    return {name: one for name, one in parts.items() if one}


def _axis(given: Any, names: FileNames) -> Any:
    """Return the labels that the command gave, each the same though its value is renamed."""
    if isinstance(given, list) and names.portable(given) != given:
        return {str(one): names.portable(one) for one in given}
    return names.portable(given)


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise NodegraphError(f"{path}: too large to be a lock")
        return path.read_text(encoding=_ENCODING)
    except FileNotFoundError:
        raise NodegraphError(f"{path}: no such file; `nodegraph lock GRAPH` writes it") from None
    except (OSError, ValueError) as error:
        raise NodegraphError(f"{path}: cannot be read as a lock: {error}") from error


def _checked(path: Path, text: str) -> Mapping[str, Any]:

    if not text.startswith(_HEAD):
        raise NodegraphError(f"{path}: this is no lock; `nodegraph lock GRAPH` writes one")
    version, _, rest = text[len(_HEAD) :].partition("\n")
    if version != str(FORMAT):
        raise NodegraphError(
            f"{path}: a lock of format {version}, and this program reads {FORMAT}: it needs the "
            "nodegraph that wrote it, or a newer one"
        )
    found = _SUM.match(rest)
    body = rest[found.end() :] if found else ""
    if found is None or hashlib.sha256(body.encode()).hexdigest() != found[1]:
        if _END.strip() not in rest:
            raise NodegraphError(f"{path}: the lock is cut off; get the whole file, or lock again")
        raise NodegraphError(
            f"{path}: the lock is not as it was written (its checksum is another); get the file "
            "as it was, or lock again"
        )
    data = read_yaml(text, str(path)).plain()
    wrong = misfit(data)
    if wrong:
        raise NodegraphError(f"{path}: {_NOT_OURS}: {wrong}")
    checked: Mapping[str, Any] = data
    return checked
