"""The notes of a table of scores, of which its reader is warned as well."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import replace

from nodegraph_mocap import Table, Trajectories
from nodegraph_tables import TableInfo, poses_of, with_info


def with_notes(
    table: Table, notes: Iterable[str], info: TableInfo, *, of: Trajectories | None = None
) -> Table:
    """Return a node's table with this information and notes, and warn the node's caller of them.

    Parameters
    ----------
    table
        The rows.
    notes
        Each without a full stop.
    info
        The information but for the notes.
    of
        The recording whose poses belong to the information, if one does.
    """
    texts = tuple(notes)
    for text in texts:
        warnings.warn(text, stacklevel=3)
    if of is not None:
        info = replace(info, poses=poses_of(of.markers, of.positions, of.rate))
    return with_info(table, replace(info, notes=tuple(f"{text}." for text in texts)))
