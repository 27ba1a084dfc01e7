"""The summary of a finished run in a terminal: answer, comparisons, warnings, failures, files."""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.formatting import number_of
from nodegraph.report.notes import NoteGroup, note_kinds
from nodegraph.report.study import NoteSubject, Section, Study
from nodegraph.runs.folder import RECORD, REPORT
from nodegraph.state import State

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from nodegraph.cli.answers import RunAnswer
    from nodegraph.execute.results import Run
    from nodegraph.plugin.hook_types import Grid

_MOST_SENTENCES = 6
_MOST_LINES = 12
_MOST_ROWS = 30
_MOST_GROUPS = 5
_GAP = 2
_LONGEST_WARNING = 100
_BEST, _TIED = "*", "~"
_LEGEND = {_BEST: "best", _TIED: "may be the best"}
_WORDS: dict[str, str] = {State.DONE: "computed", State.UNNEEDED: "not needed"}


def print_summary(
    study: Study,
    run: Run,
    folder: Path,
    console: Console,
    *,
    full: bool,
    lost: Collection[str] = (),
) -> None:
    """Print what a run gave.

    Parameters
    ----------
    study
        The content of its report.
    run
    folder
        Where it is written.
    console
    full
        Whether to print every sentence, table, warning and failure.
    lost
        Files that could not be written.
    """
    for part in (*_parts(study, run, console, full=full), f"\n{_files(study, folder, lost)}"):
        if isinstance(part, str):
            console.print(part, markup=False, soft_wrap=True)
        else:
            console.print(part)


def run_answer(study: Study, run: Run, folder: Path) -> RunAnswer:
    """Return the summary of a run as data."""
    from nodegraph.cli.answers import Note, Result, RunAnswer

    hooks = run.plan.graph.registry.hooks
    notes: dict[str, list[Note]] = {
        str(kind.kind): [
            Note(group.node, group.methods, group.reason, group.count) for group in kind.groups
        ]
        for kind in note_kinds(study)
    }
    return RunAnswer(
        title=study.title,
        ok=study.ok,
        folder=str(folder),
        report=str(folder / REPORT),
        answer=study.answer,
        results=[
            Result(node, output, labels, kind.data(value))
            for node, output, labels, value in run.reported()
            for kind in [hooks.kind(type(value), "data")]
            if kind is not None and kind.data is not None
        ],
        steps={state: count for state, count in run.counts().items() if count},
        seconds=round(run.seconds, 3),
        failed=notes.get(NoteSubject.FAILED, ()),
        refused=notes.get(NoteSubject.REFUSED, ()),
        left_out=notes.get(NoteSubject.LEFT_OUT, ()),
        warnings=notes.get(NoteSubject.WARNING, ()),
        files=[link.path for section in study.sections for link in section.files],
    )


def _parts(study: Study, run: Run, console: Console, *, full: bool) -> Iterator[str | Table]:
    sentences = study.answer if full else study.short_answer(_MOST_SENTENCES)
    # what is piped has a line per sentence
    width = console.width if console.is_terminal else sys.maxsize
    yield from (textwrap.fill(sentence, width) for sentence in sentences)
    more = len(study.answer) - len(sentences)
    if more:
        yield f"{number_of(more, 'more sentence')}: --full, or the report"
    for section in study.sections:
        yield from _section(section, console.width, full=full)
    for kind in note_kinds(study):
        if kind.kind is NoteSubject.WARNING:
            yield f"\n{kind}"
            for group in kind.groups if full else kind.groups[:_MOST_GROUPS]:
                yield from _warnings(group, full=full)
            yield from _more(len(kind.groups), full=full)
    counts = [
        f"{count:,} {_WORDS.get(state, state)}" for state, count in run.counts().items() if count
    ]
    yield f"\n{number_of(len(run.plan.steps), 'step')}: {', '.join(counts)}"
    for kind in note_kinds(study):
        if kind.kind is NoteSubject.FAILED:
            yield from map(_failure, kind.groups if full else kind.groups[:_MOST_GROUPS])
            yield from _more(len(kind.groups), full=full)
    yield from run.not_stored()


def _section(section: Section, width: int, *, full: bool) -> Iterator[str | Table]:
    """Yield a result: its comparison, else its text as far as it is short."""
    grid, text = section.rendered.grid, section.rendered.text
    name = f"{section.title} {section.labels}".strip()
    if grid is not None and not full:
        yield f"\n{grid.title if grid.title.startswith(name) else f'{name}: {grid.title}'}"
        yield from _tables(grid, width)
        marks = [mark for mark, places in ((_BEST, grid.best), (_TIED, grid.tied)) if places]
        if marks:
            yield "   ".join(f"{mark} {_LEGEND[mark]}" for mark in marks)
    elif text:
        lines = text.splitlines()
        shown = lines if full or len(lines) <= _MOST_LINES else lines[:_MOST_LINES]
        yield "\n".join(["", name, *shown])
        if len(shown) < len(lines):
            yield f"{len(lines) - len(shown)} more lines: --full, or the report"


def _tables(grid: Grid, width: int) -> Iterator[Table]:
    """Yield a comparison in as many tables, one below the other, as it takes to fit a width."""
    from rich.cells import cell_len

    rows = grid.rows[:_MOST_ROWS]
    texts = [
        [f"{text}{_mark(grid, row, column)}" for column, text in enumerate(cells)]
        for row, cells in enumerate(rows)
    ]
    # names are cut, and never numbers
    number = max((cell_len(text) for cells in texts for text in cells[1:]), default=0)
    longest = max(number, width // 2 - _GAP)
    heads = ["\n".join(_cut(line, longest) for line in head.split("\n")) for head in grid.head]
    widest = max((cell_len(line) for head in heads[1:] for line in head.split("\n")), default=0)
    room = max(1, width - max(number, widest) - 2 * _GAP)
    texts = [[_cut(name, room), *cells] for name, *cells in texts]
    heads[0] = _cut(heads[0], room)
    widths = [
        max(cell_len(line) for line in (*head.split("\n"), *cells)) + _GAP
        for head, cells in zip(heads, zip(*texts, strict=True), strict=True)
    ]
    columns = list(range(1, len(grid.head)))
    while columns:
        room, count = width - widths[0], 0
        while count < len(columns) and (not count or room >= widths[columns[count]]):
            room -= widths[columns[count]]
            count += 1
        tops = [grid.head[column].partition("\n")[0] for column in columns]
        if count < len(columns) and tops[0] != tops[count - 1] == tops[count]:
            count = tops.index(tops[count])  # groups that share a label stay together
        yield _table(grid, heads, texts, [0, *columns[:count]])
        columns = columns[count:]


def _cut(text: str, width: int) -> str:
    """Return a text that is no wider; what is longer ends in ``…``."""
    from rich.cells import cell_len, set_cell_size

    return text if cell_len(text) <= width else f"{set_cell_size(text, width - 1).rstrip()}…"


def _table(
    grid: Grid, heads: Sequence[str], texts: Sequence[Sequence[str]], columns: Sequence[int]
) -> Table:
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, padding=(0, _GAP, 0, 0), header_style="dim", pad_edge=False)
    for column in columns:
        head = Text(heads[column])
        table.add_column(head, justify="right" if column else "left", no_wrap=True)
    for row, cells in enumerate(texts):
        styles = ["bold" if (row, column) in grid.best else "" for column in columns]
        table.add_row(
            *(Text(cells[column], style) for column, style in zip(columns, styles, strict=True))
        )
    if len(grid.rows) > len(texts):
        table.add_row(Text(f"and {len(grid.rows) - len(texts)} more", "dim"))
    return table


def _mark(grid: Grid, row: int, column: int) -> str:
    if (row, column) in grid.best:
        return _BEST
    if (row, column) in grid.tied:
        return _TIED
    return " " if column else ""


def _warnings(group: NoteGroup, *, full: bool) -> Iterator[str]:
    """Yield a line on a kind of warning, with its count; in full, one for all that differ."""
    start = f"warning: {group.where}"
    differ = "\N{HORIZONTAL ELLIPSIS}" in group.reason
    if full and differ and group.labels:
        yield from (f"{start} at {label}" for label in group.labels)
        return
    at = f" at {group.labels[0]}" if group.count == len(group.labels) == 1 else ""
    times = f" ({group.count} times)" if group.count > 1 else ""
    line = f"{start}{at}: {group.reason}{times}"
    if not full and len(line) > _LONGEST_WARNING:
        room = _LONGEST_WARNING - len(times)
        line = textwrap.shorten(f"{start}: {group.reason}", room, placeholder=" …") + times
    yield line


def _failure(group: NoteGroup) -> str:
    """Return the failures, with the command that repeats the first failed step alone."""
    first = f" at {group.labels[0]}" if group.labels else ""
    more = f" and {group.count - 1} more" if group.count > 1 else ""
    repeat = f"\n    repeat it alone: {group.repeat}" if group.repeat else ""
    return f"failed: {group.where}{first}{more}: {group.reason}{repeat}"


def _more(count: int, *, full: bool) -> Iterator[str]:
    if count > _MOST_GROUPS and not full:
        yield f"{number_of(count - _MOST_GROUPS, 'more kind')}: --full, or the report"


def _files(study: Study, folder: Path, lost: Collection[str]) -> str:
    first, *rest = [name for name in (REPORT, RECORD, "") if name not in lost]
    names = [str(folder / first), *filter(None, rest)]
    return ", ".join([*names, *study.kinds_of_files])
