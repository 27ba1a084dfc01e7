"""The overview of a comparison from its summaries, and from the blocks of the gathered tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.blocks import block_means, columns_of, values_of
from nodegraph_compare.overview.value import GroupOverview, Metric, Overview, WithoutSuspects
from nodegraph_compare.scope import cluster_text
from nodegraph_compare.suspects import identifying
from nodegraph_compare.table.sensitivity import apart_by_all_rules, without_suspects
from nodegraph_compare.table.verdict import verdict_on
from nodegraph_tables import info_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from nodegraph import Across, Declared, Label
    from nodegraph_compare.blocks import Columns
    from nodegraph_compare.comparison import Comparison
    from nodegraph_compare.question import Question
    from nodegraph_compare.suspects import Suspects
    from nodegraph_compare.table.summary import Summary
    from nodegraph_mocap import Table

_MORE_METRICS = 3
_MEANS = ("mean", "low", "high", "median", "rank")
_PAIRED = {
    "ratio": "value",
    "ratio_low": "low",
    "ratio_high": "high",
    "difference": "difference",
    "difference_low": "difference_low",
    "difference_high": "difference_high",
}


def build_overview(
    comparison: Comparison,
    summaries: Sequence[Summary],
    suspects: Sequence[Suspects],
    declared: Mapping[Label, Declared],
    baseline: Label | None,
    beside: Sequence[str],
) -> Overview:
    """Return the overview of a comparison.

    Parameters
    ----------
    comparison
        What is compared.
    summaries, suspects
        Of each of its groups.
    declared
        What the methods declare.
    baseline
        What methods are compared to in place of the best; by default, the fallback stands for it.
    beside
        Further columns of numbers that are shown with the metric.
    """
    scores, question = comparison.scores, comparison.question
    methods = comparison.methods
    metrics = (
        Metric(question.metric, comparison.unit, question.better),
        *_more_metrics(scores, question, beside),
    )
    columns = columns_of(scores, identifying(scores, question))
    blocks = _Blocks(comparison, [metric.name for metric in metrics], columns)
    return Overview(
        metrics=metrics,
        beside=len(beside),
        compare=question.compare or "",
        is_sequence=blocks.is_sequence,
        within=question.within,
        blocks=comparison.blocks,
        units=cluster_text(question) if question.clusters else "",
        ratio=all(summary.ratio for summary in summaries),
        baseline=comparison.fallback if baseline is None else baseline,
        against=None if baseline is None else methods.index(baseline),
        methods=methods,
        adapted=tuple(
            at for at, method in enumerate(methods) if "adapted" in declared.get(method, {})
        ),
        ahead=tuple(
            at
            for at, method in enumerate(methods)
            if declared.get(method, {}).get("lookahead", 0) is None
        ),
        columns=dict(zip(columns.names, columns.labels, strict=True)),
        groups=tuple(
            blocks.group(summary, doubted)
            for summary, doubted in zip(summaries, suspects, strict=True)
        ),
    )


def _more_metrics(scores: Across[Table], question: Question, beside: Sequence[str]) -> list[Metric]:
    """Return the metric, then the float columns of all tables: first those in its unit."""
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
        Metric(name, first.units.get(name, ""), first.better.get(name, "lower"))
        for name in (*beside, *names[:_MORE_METRICS])
    ]


class _Blocks:
    """The rows of all tables, from which the blocks of a group take their numbers."""

    def __init__(self, comparison: Comparison, metrics: Sequence[str], columns: Columns) -> None:
        self._comparison, self._columns = comparison, columns
        first = info_of(comparison.scores.values()[0])
        self.is_sequence = comparison.question.compare in first.sequences
        place = {method: at for at, method in enumerate(comparison.methods)}
        compared = columns_of(comparison.scores, comparison.question.compared)
        # of nothing compared, the only label is empty
        labels = compared.labels[0] if compared.labels else ("",)
        self._method = np.array([place[label] for label in labels])[compared.combined()]
        self._values = {name: values_of(comparison.scores, name) for name in metrics}

    def group(self, summary: Summary, suspects: Suspects) -> GroupOverview:
        """Return one group."""
        group, paired = summary.group, summary.to_best
        methods = self._comparison.methods
        verdict = verdict_on(summary, self._comparison.question, self._comparison.blocks)
        at = np.array([methods.index(method) for method in group.methods], dtype=np.intp)

        def spread(values: NDArray[np.float64] | None) -> NDArray[np.float64]:
            full = np.full(len(methods), np.nan)
            if values is not None:
                full[at] = values
            return full

        def places(where: NDArray[np.bool_]) -> tuple[int, ...]:
            return tuple(sorted(at[where].tolist()))

        lower, higher = apart_by_all_rules(summary)
        if summary.against is None:
            lower = higher = np.zeros_like(lower)
        better, worse = (higher, lower) if summary.end == "higher" else (lower, higher)
        errors = self._errors(group.rows, group.block, len(group.values))
        lacking = np.isnan(next(iter(errors.values()))).sum(axis=0)
        other = without_suspects(summary)
        plain = None
        if other is not None:
            other_verdict = verdict_on(other, self._comparison.question, self._comparison.blocks)
            plain = WithoutSuspects(
                mean=spread(other.mean),
                best=places(other_verdict.best),
                tied=places(other_verdict.tied),
            )
        names = zip(self._columns.names, self._columns.codes, strict=True)
        return GroupOverview(
            labels=group.labels,
            speech=verdict.speech,
            scope=verdict.scope,
            caution=verdict.caution,
            objection=verdict.objection,
            best=places(verdict.best),
            tied=places(verdict.tied),
            behind=places(verdict.behind),
            better=places(better),
            worse=places(worse),
            **{name: spread(getattr(summary, name)) for name in _MEANS},
            **{
                name: spread(None if paired is None else getattr(paired, attribute))
                for name, attribute in _PAIRED.items()
            },
            p_of_step=spread(summary.p_of_step if self.is_sequence else None),
            missing=lacking.astype(np.int64),
            used=int(summary.blocks.max(initial=0)),
            unit=summary.units.place.astype(np.int64),
            suspect=dict(suspects.reasons),
            without_suspects=plain,
            rows={name: codes[group.first].astype(np.int64) for name, codes in names},
            start=group.start,
            frames=group.frames,
            errors={
                name: self._with_fallback(values).astype(np.float32)
                for name, values in errors.items()
            },
        )

    def _errors(
        self, rows: NDArray[np.intp], block: NDArray[np.intp], count: int
    ) -> dict[str, NDArray[np.float64]]:
        methods = len(self._comparison.methods)
        return {
            name: block_means(block, self._method[rows], values[rows], count, methods)[0]
            for name, values in self._values.items()
        }

    def _with_fallback(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values that count: the fallback's where a method that has any lacks one."""
        fallback = self._comparison.fallback
        if fallback is None:
            return values
        instead = values[:, [self._comparison.methods.index(fallback)]]
        lacks = np.isnan(values) & np.isfinite(values).any(axis=0)
        return np.where(lacks, instead, values)
