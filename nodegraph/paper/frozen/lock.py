"""A frozen study: everything that decided its results, and what they were, in a small text file."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from nodegraph.errors import NodegraphError
from nodegraph.execute import Run
from nodegraph.paper.frozen.account import account
from nodegraph.paper.frozen.concluded import said_by
from nodegraph.paper.frozen.names import FileNames, refuse_paths, relative
from nodegraph.paper.frozen.parts import Parts
from nodegraph.paper.frozen.recorded import Recorded, recorded
from nodegraph.paper.frozen.results import Results, cells_of
from nodegraph.paper.frozen.scales import scales
from nodegraph.paper.frozen.sketch import TOLERANCE
from nodegraph.paper.frozen.yaml_lines import yaml_lines
from nodegraph.spec.yaml_text import read_yaml

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
    from nodegraph.paper.frozen.form import misfit

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
