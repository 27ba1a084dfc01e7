"""The numbers of several runs of one study beside each other, and what changed between them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from nodegraph.errors import NodegraphError
from nodegraph.formatting import number_of
from nodegraph.report.study import Study
from nodegraph.runs.compare import Agreements, by_digest, choices, compare
from nodegraph.runs.record_files import read_record
from nodegraph.store import Store

_MOST = 12
"""Changes between two runs that are listed."""


@dataclass(frozen=True)
class Row:
    """A number of a method: in which group, and its text in each run, empty where it has none."""

    method: str
    group: str
    numbers: Sequence[str]


@dataclass(frozen=True)
class Table:
    """A table of a study: the numbers of all its runs.

    Attributes
    ----------
    title, caption : str
    compared : str
        The name of what is compared: the head of the methods.
    rows : sequence of Row
    """

    title: str
    caption: str
    compared: str
    rows: Sequence[Row]


def tables(studies: Sequence[Study]) -> list[Table]:
    """Return the tables of several runs of a study, as the last that has each names it.

    The numbers have the digits that the tables of the reports show.

    Raises
    ------
    NodegraphError
        If a table is damaged.
    """
    known: dict[tuple[str, str, str], Table] = {}
    numbers: dict[tuple[str, str, str], dict[tuple[str, str], list[str]]] = {}
    for at, study in enumerate(studies):
        for section in study.sections:
            if (grid := section.rendered.grid) is None:
                continue
            if {len(grid.head), *map(len, grid.rows)} != {max(1, len(grid.head))}:
                raise NodegraphError(
                    f"{study.title}: a row of the table {section.title!r} is not as long as its "
                    "head; run the graph again"
                )
            key = section.node, section.output, section.labels
            compared, *groups = (", ".join(name.split("\n")) for name in grid.head)
            title = ", ".join(filter(None, [section.title, section.where]))
            known[key] = Table(title, grid.title, compared, ())
            of_table = numbers.setdefault(key, {})
            for method, *texts in grid.rows:
                for group, text in zip(groups, texts, strict=True):
                    texts_of_runs = of_table.setdefault((method, group), [""] * len(studies))
                    texts_of_runs[at] = text
    return [
        Table(
            table.title,
            table.caption,
            table.compared,
            [Row(*name, texts) for name, texts in numbers[key].items()],
        )
        for key, table in known.items()
    ]


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
