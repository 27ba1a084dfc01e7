"""From gathered tables to blocks: what is compared, within what, and the value of each block."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.ties import tied
from nodegraph_tables import info_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from nodegraph import Absent, Across, Label
    from nodegraph_compare.question import Question
    from nodegraph_mocap import Table
    from nodegraph_tables import BetterEnd


@dataclass(frozen=True)
class Group:
    """The numbers that are compared under one combination of the labels of `within`.

    Attributes
    ----------
    labels : tuple of W labels
        Of the columns of `within`.
    methods : tuple of K labels
        Of the compared column, in their order; one empty label where nothing is compared.
    values : (B, K) array of float64
        The metric averaged over the rows of each block; NaN where a row of the block has no
        finite number, or the method has no such block. Numbers of a block that differ by rounding
        alone are equal (see `tied`).
    missing : (K,) array of float64
        Share of the method's rows without a finite number; NaN for a method without rows.
    refused : (K,) array of float64
        Share of the method's combinations that were refused or failed.
    cluster, draw : (B,) arrays of int
        Which cluster each block is in, and which repetition on the same data.
    draws : int
        Number of repetitions that the graph has; 1 where it repeats nothing.
    start, frames : (B,) arrays of float64
        Where each block begins in its recording, and how long it is; NaN where the tables do not
        say so, or a block is not a single stretch of time.
    span, correlation : (B,) arrays of float64
        Frames of that recording, and over how many of them it is correlated; NaN where the tables
        do not say so.
    rows, block : (R,) arrays of int
        The rows of the group among those of all tables, and the block of each.
    taken : tuple of int
        In how many blocks each method takes the value of another; empty where none may.
    recording : (B,) array of int or None
        Which recording each block is of; None where that is the cluster.
    """

    labels: tuple[Label, ...]
    methods: tuple[Label, ...]
    values: NDArray[np.float64]
    missing: NDArray[np.float64]
    refused: NDArray[np.float64]
    cluster: NDArray[np.intp]
    draw: NDArray[np.intp]
    draws: int
    start: NDArray[np.float64]
    frames: NDArray[np.float64]
    span: NDArray[np.float64]
    correlation: NDArray[np.float64]
    rows: NDArray[np.intp]
    block: NDArray[np.intp]
    taken: tuple[int, ...] = ()
    recording: NDArray[np.intp] | None = None

    @property
    def usable(self) -> NDArray[np.bool_]:
        """(K,), True for a method that has a number in some block."""
        return np.asarray(np.isfinite(self.values).any(axis=0))

    @property
    def complete(self) -> NDArray[np.bool_]:
        """(B,), True for a block in which every usable method has a number."""
        known = np.isfinite(self.values[:, self.usable])
        return np.asarray(known.all(axis=1) & self.usable.any())

    @property
    def first(self) -> NDArray[np.intp]:
        """(B,), the first row of each block."""
        first = np.full(len(self.values), np.iinfo(np.intp).max, dtype=np.intp)
        np.minimum.at(first, self.block, self.rows)
        return first

    def filled(self, fallback: Label) -> Group:
        """Return the group with one method's values where another usable one has none."""
        if fallback not in self.methods:
            return self
        instead = self.values[:, [self.methods.index(fallback)]]
        lacks = np.isnan(self.values) & self.usable
        taken = np.count_nonzero(lacks & np.isfinite(instead), axis=0)
        values = np.where(lacks, instead, self.values)
        return replace(self, values=values, taken=tuple(taken.tolist()))

    def with_worst(self, end: BetterEnd) -> Group:
        """Return the group with the worst value of the block where a usable method has none."""
        worst = (np.fmin if end == "higher" else np.fmax).reduce(self.values, axis=1)
        lacks = np.isnan(self.values) & self.usable
        return replace(self, values=np.where(lacks, worst[:, np.newaxis], self.values))


@dataclass(frozen=True)
class BlockColumns:
    """Columns of all rows as whole numbers: places in their lists of labels."""

    names: tuple[str, ...]
    labels: tuple[tuple[Label, ...], ...]
    codes: tuple[NDArray[np.intp], ...]
    rows: int

    def combined(self) -> NDArray[np.intp]:
        """Return one number per row, ordered as the labels of the columns, the last fastest."""
        number = np.zeros(self.rows, dtype=np.intp)
        for labels, codes in zip(self.labels, self.codes, strict=True):
            number = number * len(labels) + codes
        return number

    def joined(self, alike: Iterable[tuple[tuple[Label, ...], ...]]) -> NDArray[np.intp]:
        """Return `combined`, with one number for all combinations of a set."""
        number = self.combined()
        for combinations in alike:
            of = [self.number(combination) for combination in combinations]
            number[np.isin(number, of)] = of[0]
        return number

    def number(self, combination: tuple[Label, ...]) -> int:
        """Return the number of one combination of labels."""
        number = 0
        for labels, label in zip(self.labels, combination, strict=True):
            number = number * len(labels) + labels.index(label)
        return number

    def decoded(self, number: int) -> tuple[Label, ...]:
        """Return the labels that a number stands for."""
        combination: list[Label] = []
        for labels in reversed(self.labels):
            number, place = divmod(number, len(labels))
            combination.append(labels[place])
        return tuple(reversed(combination))


def groups(
    scores: Across[Table], question: Question, without: NDArray[np.intp] | None = None
) -> tuple[Group, ...]:
    """Return the groups of the gathered tables, in the order of the labels of `within`.

    Parameters
    ----------
    scores, question
        What is compared.
    without
        Rows to leave out.
    """
    within = columns_of(scores, question.within)
    compare = columns_of(scores, question.compared)
    block = columns_of(scores, question.identity).combined()
    cluster = columns_of(scores, question.clusters).joined(question.alike.clusters)
    known = question.sources or question.clusters
    recording = columns_of(scores, known).joined(question.alike.recordings)
    drawn = columns_of(scores, question.drawn)
    draw, draws = drawn.combined(), math.prod(map(len, drawn.labels))
    times = [*(_times(scores, name) for name in ("start", "frames")), *_of_takes(scores)]
    value = values_of(scores, question.metric)
    rows_of = rows_by(within.combined())
    methods = compare.combined()
    empty = _without_rows(scores, question, within, compare)
    shares = _Shares(scores, question)
    result = []
    for number in sorted({*rows_of, *empty}):
        rows = rows_of.get(number, np.empty(0, dtype=np.intp))
        kinds = sorted({*methods[rows].tolist(), *empty.get(number, ())})
        if without is not None:
            rows = np.setdiff1d(rows, without)
        labels, names = within.decoded(number), [compare.decoded(kind) for kind in kinds]
        place = np.searchsorted(kinds, methods[rows])
        blocks, of = np.unique(block[rows], return_inverse=True)
        values, missing = block_means(of, place, value[rows], len(blocks), len(kinds))
        first = np.full(len(blocks), len(block), dtype=np.intp)
        np.minimum.at(first, of, rows)
        start, frames, span, correlation = (_common(time[rows], of, time[first]) for time in times)
        refused = np.array([shares.of(labels + name) for name in names])
        names_of_methods = tuple((*name, "")[0] for name in names)
        group = Group(
            labels,
            names_of_methods,
            tied(values),
            missing,
            refused,
            cluster[first],
            draw[first],
            draws,
            start,
            frames,
            span,
            correlation,
            rows,
            of,
            recording=recording[first],
        )
        result.append(group)
    return tuple(result)


def columns_of(scores: Across[Table], names: tuple[str, ...]) -> BlockColumns:
    """Return gathered axes, their fields, or columns, of all rows of all tables."""
    lengths = [len(table) for table in scores.values()]
    columns = [
        _field(scores, name, lengths)
        if name in scores.fields
        else _axis(scores, name, lengths)
        if name in scores.axes
        else _column(scores, name)
        for name in names
    ]
    labels, codes = tuple(labels for labels, _ in columns), tuple(codes for _, codes in columns)
    return BlockColumns(names, labels, codes, sum(lengths))


def _field(
    scores: Across[Table], name: str, lengths: list[int]
) -> tuple[tuple[Label, ...], NDArray[np.intp]]:
    """Return what the labels of an axis have in common, of all rows."""
    labels, codes = _axis(scores, name.partition(".")[0], lengths)
    of = [scores.fields[name].get(label, "") for label in labels]
    order = tuple(dict.fromkeys(of))
    return order, np.array([order.index(each) for each in of], dtype=np.intp)[codes]


def _axis(
    scores: Across[Table], name: str, lengths: list[int]
) -> tuple[tuple[Label, ...], NDArray[np.intp]]:
    order = label_order(scores, name)
    place = {label: code for code, label in enumerate(order)}
    codes = np.array([place[labels.get(name, "")] for labels, _ in scores], dtype=np.intp)
    return order, np.repeat(codes, lengths)


def _column(scores: Across[Table], name: str) -> tuple[tuple[Label, ...], NDArray[np.intp]]:
    from pandas import concat, factorize

    joined = concat([table[name] for table in scores.values()], ignore_index=True)
    codes, labels = factorize(joined, use_na_sentinel=False)
    return tuple(labels.tolist()), np.asarray(codes, dtype=np.intp)


def values_of(scores: Across[Table], metric: str) -> NDArray[np.float64]:
    """Return the metric of all rows of all tables; NaN where it is not finite."""
    parts = [table[metric].to_numpy(dtype=np.float64) for table in scores.values()]
    joined = np.concatenate([*parts, np.empty(0)])
    return np.where(np.isfinite(joined), joined, np.nan)


def _times(scores: Across[Table], name: str) -> NDArray[np.float64]:
    """Return a column of frames of all rows; NaN where a table has none."""
    parts = [
        table[name].to_numpy(dtype=np.float64)
        if name in table and table[name].dtype.kind in "iuf"
        else np.full(len(table), np.nan)
        for table in scores.values()
    ]
    return np.concatenate([*parts, np.empty(0)])


def _of_takes(scores: Across[Table]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return, for all rows, the frames of their recording and over how many it is correlated."""
    takes = [info_of(table).take for table in scores.values()]
    numbers = [(take.frames, take.correlation) if take else (np.nan, np.nan) for take in takes]
    counts = [len(table) for table in scores.values()]
    span, correlation = np.repeat(np.array(numbers, dtype=np.float64), counts, axis=0).T
    return span, correlation


def _common(
    time: NDArray[np.float64], block: NDArray[np.intp], first: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the time of each block, that of its first row; NaN unless all its rows have it."""
    differs = np.bincount(block, time != first[block], len(first)) > 0
    return np.where(differs, np.nan, first)


def rows_by(numbers: NDArray[np.intp]) -> dict[int, NDArray[np.intp]]:
    """Return, for each number that occurs, the rows in which it does."""
    order = np.argsort(numbers, kind="stable")
    distinct, starts = np.unique(numbers[order], return_index=True)
    return dict(zip(distinct.tolist(), np.split(order, starts[1:]), strict=False))


def block_means(
    block: NDArray[np.intp],
    method: NDArray[np.intp],
    value: NDArray[np.float64],
    blocks: int,
    methods: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the (B, K) means of the rows of each block and the (K,) shares without a number."""
    cell, size = block * methods + method, blocks * methods
    count = np.bincount(cell, minlength=size).reshape(-1, methods)
    total = np.bincount(cell, weights=value, minlength=size).reshape(-1, methods)
    missing = np.bincount(method, weights=np.isnan(value), minlength=methods)
    rows = count.sum(axis=0)
    means = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    return means, np.where(rows > 0, missing / np.maximum(rows, 1), np.nan)


def _without_rows(
    scores: Across[Table], question: Question, within: BlockColumns, compare: BlockColumns
) -> dict[int, set[int]]:
    """Return the methods that were refused or failed, by group, if only axes distinguish them."""
    if not set(question.within + question.compared).issubset(scores.axes):
        return {}
    methods: dict[int, set[int]] = {}
    for absent in unsuccessful(scores):
        group = within.number(_pick(absent.labels, question.within))
        method = compare.number(_pick(absent.labels, question.compared))
        methods.setdefault(group, set()).add(method)
    return methods


class _Shares:
    """Counts the combinations that were refused or failed, by the axes that distinguish groups."""

    def __init__(self, scores: Across[Table], question: Question) -> None:
        names = question.within + question.compared
        self._places = [place for place, name in enumerate(names) if name in scores.axes]
        axes = tuple(names[place] for place in self._places)
        self._absent = Counter(_pick(absent.labels, axes) for absent in unsuccessful(scores))
        self._present = Counter(_pick(labels, axes) for labels, _ in scores)

    def of(self, labels: tuple[Label, ...]) -> float:
        """Return the share for the labels of a group and of a method."""
        key = tuple(labels[place] for place in self._places)
        total = self._absent[key] + self._present[key]
        return self._absent[key] / total if total else 0.0


def unsuccessful(scores: Across[object]) -> list[Absent]:
    """Return the combinations that were refused or failed, not those skipped on purpose."""
    return [absent for absent in scores.absent if absent.kind != "skipped"]


def _pick(labels: Mapping[str, Label], axes: tuple[str, ...]) -> tuple[Label, ...]:
    return tuple(labels.get(axis, "") for axis in axes)


def label_order(scores: Across[object], axis: str) -> tuple[Label, ...]:
    """Return the labels of a gathered axis in the order in which the graph lists them.

    The values along the axis, with all other labels fixed, are in that order; where some of them
    are absent, a label takes its place behind the one that it follows elsewhere. Labels without
    any value come last; labels that were only ever skipped are left out.
    """
    order: list[Label] = []
    for sequence in _sequences(scores, axis):
        if not set(order).issuperset(sequence):
            _merge(order, sequence)
    without_value = (absent.labels.get(axis, "") for absent in unsuccessful(scores))
    return tuple(dict.fromkeys([*order, *without_value]))


def _sequences(scores: Across[object], axis: str) -> Iterable[list[Label]]:
    sequences: defaultdict[tuple[Label, ...], list[Label]] = defaultdict(list)
    others = [other for other in scores.axes if other != axis]
    for labels, _ in scores:
        sequences[tuple(labels.get(other, "") for other in others)].append(labels.get(axis, ""))
    return sequences.values()


def _merge(order: list[Label], sequence: list[Label]) -> None:
    place = len(order) if set(order).isdisjoint(sequence) else 0
    for label in sequence:
        if label in order:
            place = order.index(label) + 1
        else:
            order.insert(place, label)
            place += 1
