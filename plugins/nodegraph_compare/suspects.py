"""Blocks whose truth is suspect: it jumps there, or is measured and every method errs alike."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.blocks import columns_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from nodegraph import Across
    from nodegraph_compare.blocks import BlockColumns, Group
    from nodegraph_compare.question import Question
    from nodegraph_mocap import Table

COLUMN = "suspect"
"""Column of scores with the reason why a row's truth is suspect; empty where it is not."""

MARKER = "marker"
"""Column of scores with the marker of each row."""

FARTHEST = 5.0
"""Robust standard deviations above which the smallest error of a block is suspect."""

_FEWEST = 20
_MAD = 1.4826


@dataclass(frozen=True)
class Suspects:
    """The suspect blocks of a group.

    Attributes
    ----------
    reasons : mapping of int to str
        By the place of each block in the group.
    names : tuple of str
        Of each block, with the reason: ``trial 3, gap 5, marker chin: every method errs much``.
    rows : array of int
        Their rows among those of all tables.
    """

    reasons: Mapping[int, str]
    names: tuple[str, ...]
    rows: NDArray[np.intp]


def suspects(
    scores: Across[Table], question: Question, groups: Sequence[Group]
) -> tuple[Suspects, ...]:
    """Return, for each group, the blocks whose truth is suspect.

    They are blocks with a row whose column ``suspect`` has a reason, and, of measured data, blocks
    in which every method errs much: with m the logarithm of the smallest error of a block, less the
    median of its cluster, the robust deviation ``(m - median(m)) / (1.4826 MAD(m))`` is above 5,
    over 20 blocks or more. Of a metric that has values of 0 or below, or of which low is not
    better, and of synthetic data, where such a block is hard and its truth as it was made, only
    the former.
    """
    texts = _texts(scores)

    @cache
    def columns() -> BlockColumns:
        return columns_of(scores, identifying(scores, question))

    return tuple(_suspects(columns, question, group, texts[group.rows]) for group in groups)


def _suspects(
    columns: Callable[[], BlockColumns],
    question: Question,
    group: Group,
    texts: NDArray[np.object_],
) -> Suspects:
    reasons: dict[int, str] = {}
    for place, text in zip(group.block.tolist(), texts, strict=True):
        if text:
            reasons.setdefault(place, text)
    for place in np.flatnonzero(_failed(group, question)).tolist():
        reasons.setdefault(place, "every method errs much")
    if not reasons:
        return Suspects({}, (), np.empty(0, dtype=np.intp))
    reasons = dict(sorted(reasons.items()))
    places = list(reasons)
    labels = _labels(columns(), group.first[places])
    names = tuple(f"{name}: {reasons[at]}" for name, at in zip(labels, places, strict=True))
    return Suspects(reasons, names, group.rows[np.isin(group.block, places)])


def _failed(group: Group, question: Question) -> NDArray[np.bool_]:
    """Return (B,), whether even the smallest error of a block is far above those of others."""
    none = np.zeros(len(group.values), dtype=bool)
    values = group.values[:, group.usable]
    kept = group.complete
    if question.synthetic or question.better != "lower" or values.shape[1] < 2:
        return none
    if np.count_nonzero(kept) < _FEWEST:
        return none
    if not (values[kept] > 0.0).all():
        return none
    least = np.log(values[kept].min(axis=1))
    for at in np.unique(group.cluster[kept]):
        member = group.cluster[kept] == at
        least[member] -= np.median(least[member])
    spread = _MAD * float(np.median(np.abs(least - np.median(least))))
    none[kept] = least - np.median(least) > FARTHEST * spread if spread > 0.0 else False
    return none


def _texts(scores: Across[Table]) -> NDArray[np.object_]:
    """Return the reasons of all rows of all tables."""
    parts = [
        table[COLUMN].fillna("").astype(str).to_numpy(dtype=object)
        if COLUMN in table
        else np.full(len(table), "", dtype=object)
        for table in scores.values()
    ]
    return np.concatenate([*parts, np.empty(0, dtype=object)])


def identifying(scores: Across[Table], question: Question) -> tuple[str, ...]:
    """Return the axes and columns by which a reader finds a block: the marker, if each has one."""
    names = tuple(dict.fromkeys((*question.clusters, *question.identity)))
    if MARKER not in names and all(MARKER in table for table in scores.values()):
        block = tuple(dict.fromkeys((*question.within, *names)))
        counts = [
            len(np.unique(columns_of(scores, columns).combined()))
            for columns in (block, (*block, MARKER))
        ]
        if counts[0] == counts[1]:
            names = (*names, MARKER)
    return names


def _labels(columns: BlockColumns, rows: NDArray[np.intp]) -> Sequence[str]:
    """Return what blocks are called, by a row of each."""
    parts = [
        [f"{name} {labels[code]}" for code in codes[rows].tolist()]
        for name, labels, codes in zip(columns.names, columns.labels, columns.codes, strict=True)
    ]
    return [", ".join(texts) for texts in zip(*parts, strict=True)]
