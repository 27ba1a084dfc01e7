"""The question of a comparison: which number, of what, within what, in which blocks."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from itertools import product
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import AfterValidator
from pydantic_core import PydanticCustomError

from nodegraph import Across, ColumnOf, Label, LabelOf, Value, listed, nearest
from nodegraph_compare.actors import Alike, clusters_of, find_alike, label_at
from nodegraph_tables import BetterEnd, info_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nodegraph_mocap import Table


OneColumn = Annotated[str | None, ColumnOf("scores")]
OneName = Annotated[str | None, ColumnOf("scores", or_axis=True)]
OneLabel = Annotated[str | None, LabelOf("scores", axis="compare")]
Names = Annotated[tuple[str, ...], ColumnOf("scores", or_axis=True)]
Clusters = Annotated[
    tuple[str, ...],
    ColumnOf("scores", or_axis=True, apart_from=("compare", "within", "x"), independent=True),
]


@dataclass(frozen=True)
class Margin(Value):
    """Within which methods count as equal: a factor, or a difference in some unit.

    Attributes
    ----------
    size : float
        Above 1 for a factor, above 0 for a difference.
    unit : str
        Empty for a factor.
    """

    size: float
    unit: str = ""

    @property
    def ratio(self) -> bool:
        """Whether it is a factor."""
        return not self.unit

    def __str__(self) -> str:
        return f"{self.size:g} {self.unit}".rstrip()


_MARGIN = re.compile(r"(\d+(?:\.\d*)?|\.\d+)\s*([^\s\d.].*)")


def margin_of(equivalent: float | str) -> Margin:
    """Return the margin that a setting states.

    Raises
    ------
    ValueError
        If it is neither a factor above 1 nor a number above 0 with its unit.
    """
    if not isinstance(equivalent, str):
        if not 1.0 < equivalent < math.inf:
            raise ValueError("must be above 1 as a ratio; a difference has its unit: 0.05 mm")
        return Margin(float(equivalent))
    match = _MARGIN.fullmatch(equivalent.strip())
    if match is None or not 0.0 < float(match[1]) < math.inf:
        raise ValueError("must be a ratio above 1, or a difference above 0 and its unit: 0.05 mm")
    return Margin(float(match[1]), match[2])


def _checked(equivalent: float | str) -> float | str:
    try:
        margin_of(equivalent)
    except ValueError as error:
        raise PydanticCustomError("margin", "{reason}", {"reason": str(error)}) from error
    return equivalent


Equivalent = Annotated[float | str, AfterValidator(_checked)]
"""A factor, ``1.1``, or a difference in the metric's unit, ``0.05 mm``."""


def check_known(scores: Across[Table], name: str, *, what: str = "axis or column") -> None:
    """Check that a name is a gathered axis, or a column of every table.

    Parameters
    ----------
    scores
        The gathered tables.
    name
        Of what is looked for.
    what
        What the name is called in the message; ``metric`` for what must be a column.

    Raises
    ------
    ValueError
        If a table has no such column; the message names it, and what there is instead.
    """
    axes = () if what == "metric" else (*scores.axes, *scores.fields)
    if name in axes:
        return
    for labels, table in scores:
        if name not in table.columns:
            there = "axes and columns" if axes else "columns"
            near = nearest(name, (*axes, *table.columns), what=there)
            raise ValueError(f"no {what} {name!r}{_place(labels)}; {near}")


def _place(labels: Mapping[str, Label]) -> str:
    """Return the place of a table for a message: `` in the table of trial=0``."""
    place = ", ".join(f"{axis}={label}" for axis, label in labels.items() if label != "")
    return f" in the table of {place}" if place else ""


EXTREME = {"lower": "lowest", "higher": "highest"}
"""The best mean, by the better end."""

Better = Literal["declared", "lower", "higher", "none"]


def better_end(scores: Across[Table], metric: str, better: Better) -> BetterEnd:
    """Return which end of the metric is better: as set, else as the tables declare, else lower.

    Parameters
    ----------
    scores
        The gathered tables.
    metric
        The column of numbers.
    better
        The setting; ``declared``: as the tables declare it in `TableInfo.better`.

    Raises
    ------
    ValueError
        If the tables declare different ends.
    """
    if better != "declared":
        return better
    ends = {info_of(table).better.get(metric, "lower") for table in scores.values()}
    if len(ends) > 1:
        raise ValueError(
            f"the tables declare different ends of {metric!r} as the better one: "
            f"{', '.join(sorted(ends))}; give `better`"
        )
    return ends.pop()


def sign_of(end: BetterEnd) -> float:
    """Return 1.0, or -1.0 where higher is better: the best has the lowest value times this."""
    return -1.0 if end == "higher" else 1.0


@dataclass(frozen=True, kw_only=True)
class Asked:
    """The settings that say what is compared.

    Attributes
    ----------
    metric
        The column of numbers to compare. Default: the first column of floats; columns of whole
        numbers, such as indices and lengths, are never taken by default.
    compare
        The axis, or column, whose labels are compared. Default: the last gathered axis that is
        not in `within` or `blocks`.
    within
        Axes, or columns: each combination of their labels is compared by itself.
    blocks
        Axes, or columns, whose combinations are the paired blocks, within each cluster. Default:
        every gathered axis that is not compared or in `within`, and the first column of the
        tables where it identifies the unit of a row, that is, where it holds no floats and is not
        called ``frame``. An axis named nowhere is averaged over within each block.
    clusters
        Axes, or columns, whose combinations are the independent units that claims are about.
        Default: the axes along which the data themselves differ, that is, which a node without
        inputs reads or makes its data by, but for those in `compare` and `within`; the axis
        ``actor`` alone, or a field of that name, ``recording.actor``, where there is one.
        Recordings that look like one person's count as one where nothing says who is recorded.
    better
        Which end of the metric is the better one: ``lower``, ``higher``, or ``none`` (a lag is
        best at zero). ``declared``: as the scores declare it, where they do not, ``lower``.
    fallback
        A label of `compare`: where another method has no number in a block, this one's stands, as
        it would in use. What is refused is not missing at random: a method that refuses the
        hardest blocks looks better over the rest. Two other rules are applied next to it, the
        blocks that all methods have, and the worst value of the block: a claim stands only if all
        three agree.
    """

    metric: OneColumn = None
    compare: OneName = None
    within: Names = ()
    blocks: Names = ()
    clusters: Clusters = ()
    better: Better = "declared"
    fallback: OneLabel = None


@dataclass(frozen=True)
class Question:
    """A comparison's columns; each is a gathered axis or a column of the tables.

    Attributes
    ----------
    metric : str
        A column of numbers.
    compare : str or None
    within, blocks : tuple of str
    clusters : tuple of str
        Their combinations are the independent units; without any, all blocks are of one recording.
    identity : tuple of str
        What distinguishes blocks: `blocks`, and every axis along which the data differ.
    averaged : tuple of str
        Gathered axes that are none of these: a block's value is the mean over them.
    drawn : tuple of str
        Gathered axes among the blocks along which the data do not differ, and that are not
        clusters: repetitions on the same data.
    sources : tuple of str
        Gathered axes along which the data differ, but for those that are compared or distinguish
        groups: their combinations are the recordings.
    alike : Alike
        Recordings that count as one.
    synthetic : bool
        Whether all data are made by a generator.
    better : str
        Which end of the metric is better: ``lower``, ``higher`` or ``none``.
    """

    metric: str
    compare: str | None
    within: tuple[str, ...]
    blocks: tuple[str, ...]
    clusters: tuple[str, ...]
    identity: tuple[str, ...]
    averaged: tuple[str, ...]
    drawn: tuple[str, ...]
    better: BetterEnd = "lower"
    sources: tuple[str, ...] = ()
    alike: Alike = field(default_factory=Alike)
    synthetic: bool = False

    @property
    def compared(self) -> tuple[str, ...]:
        """`compare` as a tuple of one name or none."""
        return () if self.compare is None else (self.compare,)

    @property
    def by(self) -> str:
        """The end of a title: `` by fill, length and ends``."""
        names = (*self.compared, *self.within)
        text = " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))
        return f" by {text}" if text else ""


def ask(scores: Across[Table], asked: Asked) -> Question:
    """Return the question with its defaults filled in and every name checked.

    Raises
    ------
    ValueError
        If there is no table, a name is unknown or is used twice, a block is a frame, clusters are
        not independent of each other, the metric is not a number, or the tables do not agree on its
        better end.
    """
    if not len(scores):
        raise ValueError("there is no table to compare")
    within, clusters = asked.within, asked.clusters
    free = [axis for axis in scores.axes if axis not in (*within, *asked.blocks)]
    compared = asked.compare if asked.compare is not None or not free else free[-1]
    units = asked.blocks or _default_blocks(scores, {*within, *filter(None, [compared])})
    named = (*within, *filter(None, [compared]), *units)
    check_names(scores, named, "compare, within and blocks")
    _check_blocks(units)
    taken = (*within, *filter(None, [compared]))
    sources = tuple(axis for axis in scores.sources or () if axis not in taken)
    if clusters:
        check_clusters(scores, clusters, taken, sources)
    clusters = clusters or clusters_of(scores, sources)
    identity = tuple(dict.fromkeys((*units, *clusters, *sources)))
    averaged = tuple(axis for axis in scores.axes if axis not in (*named, *identity))
    known = (*clusters, *sources)
    drawn = tuple(name for name in units if name in scores.axes and name not in known)
    value = metric_of(scores, asked.metric)
    end = better_end(scores, value, asked.better)
    alike = find_alike(scores, clusters, sources)
    columns = (value, compared, tuple(within), units, clusters, identity, averaged, drawn, end)
    return Question(*columns, sources, alike, scores.synthetic)


def unit_of(scores: Across[Table], metric: str) -> str:
    """Return the unit of the metric, as the first table has it; empty if it has none."""
    return info_of(scores.values()[0]).units.get(metric, "")


def blocks_name(scores: Across[Table], question: Question) -> str:
    """Return the plural name of the blocks: ``gaps`` where the column ``gap`` identifies them."""
    units = [name for name in question.blocks if name not in scores.axes]
    named = units or question.blocks
    return f"{named[0]}s" if len(named) == 1 else "blocks"


def _default_blocks(scores: Across[Table], taken: set[str]) -> tuple[str, ...]:
    first = scores.values()[0]
    unit = [
        str(name)
        for name in first.columns[:1]
        if first[name].dtype.kind != "f" and name != "frame" and name not in scores.axes
    ]
    return tuple(name for name in (*scores.axes, *unit) if name not in taken)


def check_names(scores: Across[Table], named: tuple[str, ...], settings: str) -> None:
    """Check that each name is used once, and is a gathered axis or a column.

    Raises
    ------
    ValueError
        If it is not; the message lists the `settings` that share a name, or what there is instead.
    """
    repeated = sorted({name for name in named if named.count(name) > 1})
    if repeated:
        raise ValueError(f"{settings} share a name: {', '.join(repeated)}")
    for name in named:
        check_known(scores, name)


def check_clusters(
    scores: Across[Table],
    clusters: tuple[str, ...],
    taken: tuple[str, ...],
    sources: tuple[str, ...],
) -> None:
    """Check that clusters hold different data, each recording being in one of them.

    Raises
    ------
    ValueError
        If a name stands twice or is of no axis, if a cluster has one label alone, or if two labels
        come from the same source.
    """
    repeated = sorted({name for name in clusters if name in taken or clusters.count(name) > 1})
    if repeated:
        raise ValueError(f"compare, within and clusters share a name: {', '.join(repeated)}")
    for name in clusters:
        check_known(scores, name)
        labels = _labels_of(scores, name)
        if len(labels) == 1:
            raise ValueError(
                f"clusters: {name!r} has one label, {listed(labels)}; without `clusters`, the "
                "result is for this recording alone"
            )
    if scores.sources is None:
        return
    there = f"axes along which they differ: {listed(sources)}" if sources else "they never differ"
    of: dict[tuple[Label, ...], tuple[Label, ...]] = {}
    for at, table in scores:
        recording = tuple(at.get(axis, "") for axis in sources)
        columns = (
            table[name].unique().tolist() if name in table else [label_at(scores, name, at)]
            for name in clusters
        )
        for cluster in product(*columns):
            if of.setdefault(recording, cluster) != cluster:
                raise ValueError(
                    f"clusters: the same data stand behind {listed(clusters)} "
                    f"{listed(of[recording])} and {listed(cluster)}, so that these are not "
                    f"independent; {there}"
                )


def _labels_of(scores: Across[Table], name: str) -> tuple[Label, ...]:
    if name in scores.fields:
        return tuple(dict.fromkeys(scores.fields[name].values()))
    if name in scores.axes:
        return scores.labels(name)
    columns = (table[name].unique().tolist() for table in scores.values())
    return tuple(dict.fromkeys(label for column in columns for label in column))


def _check_blocks(blocks: tuple[str, ...]) -> None:
    if "frame" in blocks:
        raise ValueError(
            "blocks: the frames of a take follow each other and are not independent blocks, so "
            "that their number would make any difference look certain; name axes such as trial or "
            "take"
        )


def metric_of(scores: Across[Table], metric: str | None, *, but: str = "") -> str:
    """Return a column of numbers: as set, else the first of floats, but for one.

    Raises
    ------
    ValueError
        If there is none.
    """
    first = scores.values()[0]
    floats = [str(name) for name in first if first[name].dtype.kind == "f" and name != but]
    if metric is None and not floats:
        raise ValueError(f"the tables have no column of floats; columns: {listed(first.columns)}")
    column = floats[0] if metric is None else metric
    check_numbers(scores, column, "metric")
    return column


def check_numbers(scores: Across[Table], name: str, what: str) -> None:
    """Check that a name is a column of numbers of every table.

    Raises
    ------
    ValueError
        If it is not; the message says `what` it is to be, and what there is instead.
    """
    check_known(scores, name, what="metric")
    for labels, table in scores:
        if table[name].dtype.kind not in "iuf":
            numbers = [column for column in table if table[column].dtype.kind in "iuf"]
            raise ValueError(
                f"{what} {name!r} is not a column of numbers{_place(labels)}; "
                f"there are: {listed(numbers)}"
            )


def suited_margin(equivalent: float | str, question: Question, unit: str, *, ratio: bool) -> Margin:
    """Return the margin that a setting states, if it suits the metric.

    Parameters
    ----------
    equivalent
        The setting.
    question
        What is compared.
    unit
        Of the metric.
    ratio
        Whether the metric has ratios.

    Raises
    ------
    ValueError
        If it is a ratio and the metric has none, or has another unit than the metric.
    """
    margin = margin_of(equivalent)
    if margin.ratio and not ratio:
        example = f"0.05 {unit}".rstrip()
        raise ValueError(
            f"equivalent: {question.metric} has means of 0 or below, which have no ratio; give a "
            f"difference, such as {example}"
        )
    if not margin.ratio and margin.unit != unit:
        raise ValueError(
            f"equivalent: {margin} is not in the unit of {question.metric}, "
            f"{unit or 'which has none'}"
        )
    return margin
