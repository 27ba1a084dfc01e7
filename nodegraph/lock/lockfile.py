"""The file of a lock: a comment, its format, a checksum, and the locked study as YAML."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path
from zipfile import is_zipfile

from pydantic import ValidationError

from nodegraph.errors import NodegraphError
from nodegraph.execute import Run
from nodegraph.graphfile.yaml_text import read_yaml
from nodegraph.lock.conclusions import reported_by
from nodegraph.lock.document import LockedChoices, LockedResults, LockedStudy
from nodegraph.lock.provenance import FileNames, provenance, refuse_paths, relative
from nodegraph.lock.results import Results, cells_of, recorded, scales
from nodegraph.lock.sketch import TOLERANCE
from nodegraph.lock.yaml_lines import yaml_lines
from nodegraph.validation_errors import first_error

FORMAT = 1
SUFFIX = ".lock"
_HEAD = """\
# What decided the results of a study, and what they were. `nodegraph verify` checks it.
# It is written by `nodegraph lock`, and an edit by hand makes it useless.
nodegraph_lock: """
_END = "# end of the lock\n"
_CHECKSUM = re.compile(r"checksum: ([0-9a-f]{64})\n")
_MOST_BYTES = 200_000_000
_ENCODING = "utf-8-sig"
"""The encoding that also reads the byte order mark that some editors write."""


@dataclass(frozen=True)
class Lock:
    """A lock with its place."""

    path: Path
    study: LockedStudy

    @property
    def graph(self) -> Path:
        """The graph file, if it is still there."""
        return self.path.parent / self.study.graph


def lock_text(run: Run, path: Path) -> str:
    """Return the text of a lock of a run, to be written to `path`.

    Raises
    ------
    NodegraphError
        If it would contain an absolute path of this machine.
    """
    spec = run.plan.graph.spec
    names = FileNames(run.plan.graph)
    file = Path(spec.file).name
    reported, results = list(reported_by(run)), Results(run)
    study = LockedStudy(
        graph=relative(spec.folder / file, path.parent),
        title=spec.title or file,
        tolerance=TOLERANCE,
        choices=_choices(run, names),
        **dict(provenance(run, names)),
        conclusions={
            value.name: list(value.conclusions) for value in reported if value.conclusions
        },
        tables={value.name: value.table for value in reported},
        results=_results(run, results),
        text={file: spec.text, **spec.included},
    )
    data = study.model_dump(by_alias=True, exclude_defaults=True)
    body = "".join(f"{line}\n" for line in yaml_lines(data)) + _END
    refuse_paths(body, (spec.folder, Path.home()))
    checksum = hashlib.sha256(body.encode()).hexdigest()
    return f"{_HEAD}{FORMAT}\nchecksum: {checksum}\n{body}"


def is_lock(path: Path) -> bool:
    """Return whether a file is a lock, even a damaged one or one of another format."""
    with path.open(encoding=_ENCODING, errors="replace") as file:
        return file.read(len(_HEAD)) == _HEAD


def read_lock(path: Path) -> Lock:
    """Return the lock in a file.

    Raises
    ------
    NodegraphError
        If there is none, or if it was edited or written by another version.
    """
    text = _text(path)
    _check(path, text)
    return Lock(path, study_from(read_yaml(text, str(path)).plain(), path))


def study_from(data: object, path: Path) -> LockedStudy:
    """Return the study of a lock from its data.

    Raises
    ------
    NodegraphError
        With the key of the first value that is not valid.
    """
    try:
        return LockedStudy.model_validate(data)
    except ValidationError as error:
        raise NodegraphError(f"{path}: not a valid lock: {first_error(error, data)}") from error


def _results(run: Run, results: Results) -> dict[str, LockedResults]:
    cells = list(cells_of(run))
    usual = scales(cells, results, run)
    by_group: dict[str, LockedResults] = {}
    for cell in cells:
        scale = usual.get(cell.group, {})
        along = [axis for axis in cell.labels if axis != cell.node]
        group = by_group.setdefault(cell.group, LockedResults(along=along, scale=scale, steps={}))
        group.steps[cell.at] = recorded(cell, results, scale)
    return by_group


def _choices(run: Run, names: FileNames) -> LockedChoices:
    choices = run.plan.graph.choices
    return LockedChoices(
        inputs=names.portable(choices.inputs),
        axis={name: _axis(value, names) for name, value in choices.axes.items()},
        only={name: list(labels) for name, labels in choices.only.items()},
    )


def _axis(value: object, names: FileNames) -> object:
    """Return the value of an axis, with the same labels though their files are renamed."""
    renamed = names.portable(value)
    if isinstance(value, list) and renamed != value:
        return dict(zip(map(str, value), renamed, strict=True))
    return renamed


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
        if isinstance(error, UnicodeDecodeError) and is_zipfile(path):
            raise NodegraphError(
                f"{path}: {reason}: it is an archive; unpack it, and name the lock in it"
            ) from None
        raise NodegraphError(f"{path}: {reason}: {error}") from error


def _check(path: Path, text: str) -> None:
    """Raise an error if the text is not that of a lock of this format, as it was written."""
    if not text.startswith(_HEAD):
        raise NodegraphError(f"{path}: this is not a lock; `nodegraph lock GRAPH` writes one")
    version, _, rest = text[len(_HEAD) :].partition("\n")
    if version != str(FORMAT):
        raise NodegraphError(
            f"{path}: the format of the lock is {version}, but this version of nodegraph reads "
            f"{FORMAT}; use the version that wrote it, or a newer one"
        )
    match = _CHECKSUM.match(rest)
    body = rest[match.end() :] if match else ""
    if match is None or hashlib.sha256(body.encode()).hexdigest() != match[1]:
        if _END.strip() not in rest:
            raise NodegraphError(f"{path}: the lock is truncated; get the whole file or lock again")
        raise NodegraphError(
            f"{path}: the lock was edited (its checksum does not match); get the original file, "
            "or lock again"
        )
