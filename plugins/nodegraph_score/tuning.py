"""The values of settings that methods have chosen by the recordings that they were given."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from nodegraph import Across, node
from nodegraph_mocap import Table, Trajectories
from nodegraph_tables import TableInfo, with_info

if TYPE_CHECKING:
    from nodegraph_mocap.tuning import Choice


@node("score.tuning")
def tuning(recordings: Across[Trajectories], *, methods: str = "fill", columns: str = "") -> Table:
    """Show the values that methods have chosen for their settings, a row per method and setting.

    A cell has the value that was chosen most often, and for how many of the recordings. Those that
    were not tuned, such as takes that are too short, do not count.

    Parameters
    ----------
    recordings
        What tuned methods, such as fills with `settings` tuned, have made of recordings.
    methods
        The axis of the methods.
    columns
        The axis whose labels have a column each; none if it is empty: one column for all.

    Returns
    -------
    Table
        The method, the setting, its value before, and those chosen.
    """
    from pandas import DataFrame

    chosen: dict[tuple[str, str, str], dict[str, Counter[str]]] = {}
    heads: dict[str, None] = {}
    for labels, recording in recordings.entries:
        if recording.tuning is None or not recording.tuning.tries:
            continue
        head = f"{columns} {labels[columns]}" if columns in labels else "chosen"
        heads[head] = None
        for name, before, after in recording.tuning.settings:
            row = str(labels.get(methods, "")), name, _text(before)
            chosen.setdefault(row, {}).setdefault(head, Counter())[_text(after)] += 1
    rows = [
        (*row, *(_most_often(cells.get(head, Counter())) for head in heads))
        for row, cells in chosen.items()
    ]
    table = DataFrame.from_records(rows, columns=[methods, "setting", "as published", *heads])
    notes = () if rows else ("No recording here is by a method whose settings were tuned.",)
    info = TableInfo("Values chosen by tuning", labels=(methods, "setting"), notes=notes)
    return with_info(table, info)


def _most_often(values: Counter[str]) -> str:
    if not values:
        return ""
    ((value, count),) = values.most_common(1)
    return f"{value} ({count} of {values.total()})"


def _text(value: Choice) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, (int, float)) else str(value)
