"""The numbers of several runs of one study beside each other, and what changed between them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from nodegraph.errors import NodegraphError
from nodegraph.formatting import number_of
from nodegraph.report.study import Study
from nodegraph.runs.compare import Agreements, by_digest, choices, compare, digests_of
from nodegraph.runs.record_files import read_record
from nodegraph.store import Store

_MOST = 12
"""Changes between two runs that are listed."""


@dataclass(frozen=True)
class Table:
    """A group of a table of a study: the numbers of all its runs.

    Attributes
    ----------
    title, caption : str
    compared : str
        The name of what is compared: the head of the methods.
    rows : mapping of str to list of str
        The texts of a method's number in each run, empty where it has none.
    """

    title: str
    caption: str
    compared: str
    rows: Mapping[str, Sequence[str]]


def tables(studies: Sequence[Study]) -> list[Table]:
    """Return the tables of several runs of a study, as the last that has each names it.

    The numbers have the digits that the tables of the reports show: as many within a group.

    Raises
    ------
    NodegraphError
        If a table is damaged.
    """
    known: dict[tuple[str, str, str], dict[str, Table]] = {}
    for at, study in enumerate(studies):
        for section in study.sections:
            if (grid := section.rendered.grid) is None:
                continue
            if {len(grid.head), *map(len, grid.rows)} != {max(1, len(grid.head))}:
                raise NodegraphError(
                    f"{study.title}: a row of the table {section.title!r} is not as long as its "
                    "head; run the graph again"
                )
            groups = known.setdefault((section.node, section.output, section.labels), {})
            compared, *names = (", ".join(name.split("\n")) for name in grid.head)
            for column, group in enumerate(names, 1):
                rows = dict(groups[group].rows) if group in groups else {}
                for row in grid.rows:
                    texts = rows.get(row[0], [""] * len(studies))
                    rows[row[0]] = [*texts[:at], row[column], *texts[at + 1 :]]
                title = ", ".join(filter(None, [section.title, section.where, group]))
                groups[group] = Table(title, grid.title, compared, rows)
    return [table for groups in known.values() for table in groups.values()]


def data_of(folder: Path, store: Store) -> frozenset[tuple[str, ...]]:
    """Return the digests of the data of a run: of the results of nodes that take nothing in.

    Where a digest is not known, settings and files stand for it. Empty where the record cannot be
    read.

    Parameters
    ----------
    folder
        That of the run.
    store
        Has the digests of results that the run did not load.
    """
    try:
        steps = read_record(folder).steps
    except NodegraphError:
        return frozenset()
    return frozenset(
        digests_of(step, store) or (str(step.settings), *step.files.values())
        for step in steps
        if step.has_result and not step.inputs
    )


def changes_between(was: Path, now: Path, store: Store) -> list[str]:
    """Return what changed from one run to another, a sentence each: what `diff` finds first.

    Parameters
    ----------
    was, now
        The folders of the runs.
    store
        Has the digests of results that a run did not load.
    """
    try:
        before, after = read_record(was), read_record(now)
    except NodegraphError:
        return ["The record of one of the two cannot be read, so what changed is not known."]
    agreements = compare(before, after, by_digest(store))
    if agreements.is_equal:
        return [f"Nothing: {number_of(agreements.same, 'combination')}, all with the same results."]
    lines = [*choices(before, after), *_changes(agreements)]
    more = [f"and {number_of(len(lines) - _MOST, 'further change')}"] if lines[_MOST:] else []
    return lines[:_MOST] + more


def _changes(agreements: Agreements) -> Iterator[str]:
    for cells, run in ((agreements.only_was, "the earlier"), (agreements.only_now, "the later")):
        if cells:
            counts = Counter(cell.node for cell in cells)
            yield f"only in {run}: " + ", ".join(f"{node} ({n})" for node, n in counts.items())
    for same in agreements.by_change():
        pair, judged = same[0]
        groups = {other.cell.group for other, _ in same}
        name = pair.cell.group if len(groups) == 1 else pair.cell.node
        reasons = filter(None, [*pair.change.own, *pair.change.around, judged.text])
        yield f"{name}: " + ("; ".join(reasons) or "other results, of the same settings and code")
    if unknown := agreements.unknown.total():
        yield f"{number_of(unknown, 'result')} not compared, as they were not stored"
