"""The data of an overview for the scripts of a page, within a budget.

Numbers of blocks are 16-bit codes, little endian, as base64 text. 65535 stands for no number; a
value is ``exp(low + (high - low) code / 65534)``, or without exp where a metric has values of 0 or
below.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph_compare.overview.words import title_parts, varying

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nodegraph import Label, Origin
    from nodegraph_compare.overview.value import GroupOverview, Overview

_NOTHING = 65535
_MOST_NUMBERS = 400_000
"""Errors in a page: of all blocks, methods and metrics, two bytes each."""

_MOST_BLOCKS = 20_000


@dataclass(frozen=True)
class Excerpt:
    """What of an overview a page holds.

    Attributes
    ----------
    metrics : int
        So many of the first metrics.
    blocks : tuple of (N,) array of int
        The places of the blocks of each group.
    """

    metrics: int
    blocks: tuple[NDArray[np.intp], ...]

    def used(self, overview: Overview, column: str) -> NDArray[np.int64]:
        """Return which labels of a column the blocks have."""
        pairs = zip(overview.groups, self.blocks, strict=True)
        codes = [group.rows[column][blocks] for group, blocks in pairs]
        return np.unique(np.concatenate([*codes, np.empty(0, dtype=np.int64)]))


def excerpt_of(overview: Overview) -> Excerpt:
    """Return the part of an overview that a page holds: all blocks, or some and the suspect ones.

    Before blocks are left out, metrics are.
    """
    rows = sum(len(group.unit) for group in overview.groups)
    numbers = rows * len(overview.methods)
    metrics = len(overview.metrics)
    while metrics > 1 and metrics * numbers > _MOST_NUMBERS:
        metrics -= 1
    step = max(1, -(-numbers // _MOST_NUMBERS), -(-rows // _MOST_BLOCKS))
    blocks = [np.arange(0, len(group.unit), step) for group in overview.groups]
    if step > 1:
        suspect = (
            np.array([*group.suspect][:_MOST_BLOCKS], dtype=np.intp) for group in overview.groups
        )
        blocks = list(map(np.union1d, blocks, suspect))
    return Excerpt(metrics, tuple(blocks))


def packed(
    overview: Overview,
    named: Overview,
    excerpt: Excerpt,
    title: str,
    origin: Origin,
    seconds: Mapping[Label, float],
) -> dict[str, Any]:
    """Return the overview as JSON has it.

    Parameters
    ----------
    overview
        The comparison.
    named
        The same with labels as a reader sees them; see `with_units`.
    excerpt
        What of it the page holds.
    title
        Of the section.
    origin
        Of the run.
    seconds
        The time that a method takes, of those of which it is known.
    """
    uses = origin.uses(overview.compare)
    columns = {name: excerpt.used(overview, name) for name in overview.columns}
    return {
        "node": origin.node,
        "title": title,
        "question": origin.caption,
        "metric": overview.metric.name,
        "unit": overview.metric.unit,
        "better": overview.metric.better,
        "compare": overview.compare,
        "is_sequence": overview.is_sequence,
        "baseline": None if overview.baseline is None else str(overview.baseline),
        "blocks_name": overview.blocks,
        "units_name": overview.units,
        "within": [
            {
                "name": name,
                "labels": list(dict.fromkeys(group.labels[axis] for group in overview.groups)),
                "texts": list(dict.fromkeys(group.labels[axis] for group in named.groups)),
                "meaning": origin.meaning(name),
            }
            for axis, name in enumerate(overview.within)
        ],
        "methods": [
            {
                "label": str(method),
                "seconds": seconds.get(method),
                "marks": [
                    *(["adapted"] if place in overview.adapted else []),
                    *(["whole take"] if place in overview.ahead else []),
                ],
                "use": uses.get(method, ""),
            }
            for place, method in enumerate(overview.methods)
        ],
        "metrics": [
            {"name": metric.name, "unit": metric.unit, "better": metric.better}
            for metric in overview.metrics[: excerpt.metrics]
        ],
        "groups": [
            {
                **_group(overview, group, excerpt.metrics, blocks, columns),
                "texts": list(shown.labels),
                "title": ", ".join(title_parts(named, shown)),
            }
            for group, shown, blocks in zip(
                overview.groups, named.groups, excerpt.blocks, strict=True
            )
        ],
        "shown_group": _shown_group(overview),
        "columns": {
            name: {"labels": [str(overview.columns[name][code]) for code in used.tolist()]}
            for name, used in columns.items()
        },
    }


def _shown_group(overview: Overview) -> int:
    """Return the group that charts of one group begin with: the last in sight with numbers."""
    axes, first = varying(overview)[:-1], overview.groups[0].labels
    along = [
        at
        for at, group in enumerate(overview.groups)
        if all(group.labels[axis] == first[axis] for axis in axes)
    ]
    known = [at for at in along if np.isfinite(overview.groups[at].mean).any()]
    return (known or along)[-1]


def _group(
    overview: Overview,
    group: GroupOverview,
    metrics: int,
    blocks: NDArray[np.intp],
    columns: Mapping[str, NDArray[np.int64]],
) -> dict[str, object]:
    place = {block: at for at, block in enumerate(blocks.tolist())}
    other = group.without_suspects
    errors, scales = {}, {}
    for metric in overview.metrics[:metrics]:
        errors[metric.name], scales[metric.name] = _codes(group.errors[metric.name][blocks])
    rows = {
        name: _text(np.searchsorted(columns[name], codes[blocks]))
        for name, codes in group.rows.items()
    }
    return {
        "labels": list(group.labels),
        "blocks": group.used,
        "all_blocks": len(group.unit),
        "scope": group.scope,
        "speech": group.speech,
        "caution": group.caution,
        "objection": group.objection,
        **{name: _numbers(getattr(group, name)) for name in ("mean", "low", "high", "median")},
        "rank": _numbers(group.rank),
        "ratio_name": "ratio" if overview.ratio else "difference",
        "ratio": _numbers(group.ratio),
        "ratio_low": _numbers(group.ratio_low),
        "ratio_high": _numbers(group.ratio_high),
        "difference": _numbers(group.difference),
        "difference_low": _numbers(group.difference_low),
        "difference_high": _numbers(group.difference_high),
        "best": list(group.best),
        "tied": list(group.tied),
        "behind": list(group.behind),
        "missing": group.missing.tolist(),
        "suspects": len(group.suspect),
        "without_suspects": None
        if other is None
        else {"mean": _numbers(other.mean), "best": list(other.best), "tied": list(other.tied)},
        "unit": _text(group.unit[blocks]),
        "rows": rows,
        "start": _numbers(group.start[blocks]) if np.isfinite(group.start).any() else None,
        "frames": _numbers(group.frames[blocks]) if np.isfinite(group.frames).any() else None,
        "suspect": {
            str(place[block]): reason for block, reason in group.suspect.items() if block in place
        },
        "errors": errors,
        "scale": scales,
    }


def _codes(values: NDArray[np.float32]) -> tuple[str, dict[str, object]]:
    """Return values as codes and the scale of these."""
    known = np.isfinite(values)
    numbers = values[known].astype(np.float64)
    log = bool(len(numbers)) and bool((numbers > 0).all())
    numbers = np.log(numbers) if log else numbers
    low, high = (float(numbers.min()), float(numbers.max())) if len(numbers) else (0.0, 0.0)
    codes = np.full(values.shape, _NOTHING)
    width = high - low or 1.0
    codes[known] = np.rint((numbers - low) / width * (_NOTHING - 1))
    return _text(codes), {"log": log, "low": low, "high": high}


def _text(codes: NDArray[Any]) -> str:
    """Return whole numbers below 65535 as base64 text; -1 becomes 65535."""
    return base64.b64encode((codes & _NOTHING).astype("<u2").tobytes()).decode()


def _numbers(values: NDArray[np.float64]) -> list[float | None]:
    """Return numbers to six digits; None for those that are not finite."""
    return [float(f"{x:.6g}") if np.isfinite(x) else None for x in values.tolist()]
