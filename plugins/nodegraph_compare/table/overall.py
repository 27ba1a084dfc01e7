"""The comparison over all groups: of each unit, the geometric mean over groups of its means."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.blocks import Group
from nodegraph_compare.table.sensitivity import COMMON, WORST
from nodegraph_compare.table.summary import Variant, summarise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph import Label
    from nodegraph_compare.table.summary import Summary


def over_groups(summaries: Sequence[Summary]) -> Summary | None:
    """Return the summary over all groups, with those by other rules for missing blocks.

    With ``Y[c, m]`` the logarithm of the mean of method m in cluster c, averaged over groups,
    methods are compared as within a group: there is one comparison, which needs no factor for the
    number of groups. A method that lacks numbers in some group does not take part.

    Parameters
    ----------
    summaries
        Of each group.

    Returns
    -------
    Summary or None
        None for a single group, and where groups differ in their clusters or have no ratios.
    """
    overall = _combined(summaries)
    if overall is None:
        return None
    variants = []
    for rule in (COMMON, WORST):
        others = [each.summary for s in summaries for each in s.variants if each.rule == rule]
        if not others:
            continue
        other = _combined(others) if len(others) == len(summaries) else None
        if other is None:
            return None
        variants.append(Variant(rule, other))
    return replace(overall, variants=tuple(variants))


def _combined(summaries: Sequence[Summary]) -> Summary | None:
    if len(summaries) < 2 or not all(summary.ratio for summary in summaries):
        return None
    first = summaries[0]
    clusters = [np.unique(s.group.cluster[s.group.complete]) for s in summaries]
    if not all(s.units.kind == "clusters" for s in summaries) or not all(
        np.array_equal(each, clusters[0]) for each in clusters
    ):
        return None
    common = set.intersection(*({*_usable(summary)} for summary in summaries))
    methods = tuple(method for method in _usable(first) if method in common)
    if len(methods) < 2:
        return None
    places = [[_usable(s).index(method) for method in methods] for s in summaries]
    logs = [np.log(s.units.means[:, at]) for s, at in zip(summaries, places, strict=True)]
    columns = [[s.group.methods.index(method) for method in methods] for s in summaries]
    lost = list(zip(summaries, columns, strict=True))
    count = len(clusters[0])
    nowhere = np.full(count, np.nan)
    group = Group(
        labels=(),
        methods=methods,
        values=np.exp(np.mean(logs, axis=0)),
        missing=np.mean([s.group.missing[at] for s, at in lost], axis=0),
        refused=np.mean([s.group.refused[at] for s, at in lost], axis=0),
        # each cluster is a block of its own
        cluster=np.arange(count),
        draw=np.zeros(count, dtype=np.intp),
        draws=1,
        start=nowhere,
        frames=nowhere,
        rows=np.arange(count),
        block=np.arange(count),
    )
    against = None if first.against is None else first.group.methods[first.against]
    overall = summarise(group, first.end, ratio=True, against=against, margin=first.margin)
    blocks = sum(int(summary.blocks.max()) for summary in summaries)
    return replace(
        overall,
        blocks=np.full(len(methods), blocks),
        median=np.full(len(methods), np.nan),
    )


def _usable(summary: Summary) -> tuple[Label, ...]:
    pairs = zip(summary.group.methods, summary.group.usable, strict=True)
    return tuple(method for method, usable in pairs if usable)
