"""The blocks behind the verdicts of a comparison, from the gathered tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.blocks import block_means, columns_of, values_of
from nodegraph_compare.overview.value import Blocks
from nodegraph_compare.suspects import identifying
from nodegraph_compare.verdict import Metric
from nodegraph_tables import info_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from nodegraph import Across, Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.comparison import Comparison
    from nodegraph_compare.question import Question
    from nodegraph_compare.suspects import Suspects
    from nodegraph_compare.units import Units
    from nodegraph_mocap import Table

_MORE_METRICS = 3


def metrics_of(comparison: Comparison, beside: Sequence[str], *, ratio: bool) -> tuple[Metric, ...]:
    """Return what is compared, what is shown next to it, and more numbers of the same blocks.

    Parameters
    ----------
    comparison, beside
        What is compared, and shown next to it.
    ratio
        Whether methods are compared by ratios.
    """
    question = comparison.question
    first = Metric(question.metric, comparison.unit, question.better, ratio)
    return (first, *_more_metrics(comparison.scores, question, beside))


def _more_metrics(scores: Across[Table], question: Question, beside: Sequence[str]) -> list[Metric]:
    """Return some metrics, then the float columns of all tables: first those in the same unit."""
    tables = scores.values()
    taken = {question.metric, *question.within, *question.compared, *question.identity, *beside}
    first = info_of(tables[0])
    names = [
        str(name)
        for name in tables[0].columns
        if name not in taken
        and name not in scores.axes
        and first.better.get(name) != "none"
        and all(name in table and table[name].dtype.kind == "f" for table in tables)
    ]
    unit = first.units.get(question.metric)
    names.sort(key=lambda name: (first.units.get(name) != unit, name not in first.better))
    return [
        Metric(
            name,
            first.units.get(name, ""),
            first.better.get(name, "lower"),
            ratio=bool((np.nan_to_num(values_of(scores, name), nan=1.0) > 0.0).all()),
        )
        for name in (*beside, *names[:_MORE_METRICS])
    ]


class BlocksOf:
    """The rows of all tables, from which the blocks of a group take their numbers.

    Attributes
    ----------
    columns : mapping of str to tuple of label
        The labels of what identifies blocks.
    """

    def __init__(self, comparison: Comparison, metrics: Sequence[Metric]) -> None:
        scores, question = comparison.scores, comparison.question
        self._comparison = comparison
        self._identity = columns_of(scores, identifying(scores, question))
        self.columns: Mapping[str, tuple[Label, ...]] = dict(
            zip(self._identity.names, self._identity.labels, strict=True)
        )
        place = {method: at for at, method in enumerate(comparison.methods)}
        compared = columns_of(scores, question.compared)
        # of nothing compared, the only label is empty
        labels = compared.labels[0] if compared.labels else ("",)
        self._method = np.array([place[label] for label in labels])[compared.combined()]
        self._values = {metric.name: values_of(scores, metric.name) for metric in metrics}

    def of(self, group: Group, units: Units, suspects: Suspects) -> Blocks:
        """Return the blocks of a group, whose units are known, with those that are suspect."""
        count, methods = len(group.values), len(self._comparison.methods)
        method = self._method[group.rows]
        errors = {
            name: block_means(group.block, method, values[group.rows], count, methods)[0]
            for name, values in self._values.items()
        }
        names = zip(self._identity.names, self._identity.codes, strict=True)
        return Blocks(
            cluster=np.append(units.strata, -1)[units.place].astype(np.int64),
            suspect=dict(suspects.reasons),
            rows={name: codes[group.first].astype(np.int64) for name, codes in names},
            start=group.start,
            frames=group.frames,
            errors={
                name: self._with_fallback(values).astype(np.float32)
                for name, values in errors.items()
            },
        )

    def _with_fallback(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values that count: the fallback's where a method that has any lacks one."""
        fallback = self._comparison.fallback
        if fallback is None:
            return values
        instead = values[:, [self._comparison.methods.index(fallback)]]
        lacks = np.isnan(values) & np.isfinite(values).any(axis=0)
        return np.where(lacks, instead, values)


def cluster_means(blocks: Blocks, metric: Metric) -> NDArray[np.float64]:
    """Return (K,) the means over clusters of the means of their blocks; NaN where there is none."""
    errors = blocks.errors[metric.name].astype(np.float64)
    means = np.full(errors.shape[1], np.nan)
    for method, values in enumerate(errors.T):
        used = np.isfinite(values) & (blocks.cluster >= 0)
        if used.any():
            count = np.bincount(blocks.cluster[used])
            sums = np.bincount(blocks.cluster[used], values[used])
            of = sums[count > 0] / count[count > 0]
            means[method] = np.exp(np.log(of).mean()) if metric.ratio else of.mean()
    return means
