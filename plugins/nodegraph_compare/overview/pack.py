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

from nodegraph_compare.words import group_title, times_text, varying

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.overview.value import Blocks, Overview
    from nodegraph_compare.verdict import Verdict, Verdicts

_NOTHING = 65535
_MOST_NUMBERS = 400_000
"""Errors in a page: of all blocks, methods and metrics, two bytes each."""

_MOST_BLOCKS = 20_000


@dataclass(frozen=True)
class Excerpt:
    """The part of an overview that a page holds.

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
        pairs = zip(overview.blocks, self.blocks, strict=True)
        codes = [group.rows[column][blocks] for group, blocks in pairs]
        return np.unique(np.concatenate([*codes, np.empty(0, dtype=np.int64)]))


def excerpt_of(overview: Overview) -> Excerpt:
    """Return the part of an overview that a page holds: all blocks, or some and the suspect ones.

    Before blocks are left out, metrics are.
    """
    rows = sum(len(behind.cluster) for behind in overview.blocks)
    numbers = rows * len(overview.verdicts.methods)
    metrics = len(overview.metrics)
    while metrics > 1 and metrics * numbers > _MOST_NUMBERS:
        metrics -= 1
    step = max(1, -(-numbers // _MOST_NUMBERS), -(-rows // _MOST_BLOCKS))
    blocks = [np.arange(0, len(behind.cluster), step) for behind in overview.blocks]
    if step > 1:
        suspect = (
            np.array([*behind.suspect][:_MOST_BLOCKS], dtype=np.intp) for behind in overview.blocks
        )
        blocks = list(map(np.union1d, blocks, suspect))
    return Excerpt(metrics, tuple(blocks))


def packed(
    overview: Overview,
    named: Verdicts,
    excerpt: Excerpt,
    node: str,
    seconds: Mapping[Label, float],
) -> dict[str, Any]:
    """Return the overview as JSON has it.

    Parameters
    ----------
    overview
        The comparison.
    named
        Its verdicts as a reader sees them; see `with_units`.
    excerpt
        What of it the page holds.
    node
        Of the run, that made it.
    seconds
        The time that a method takes, of those of which it is known.
    """
    verdicts = overview.verdicts
    columns = {name: excerpt.used(overview, name) for name in overview.columns}
    return {
        "node": node,
        "metric": verdicts.metric.name,
        "compare": verdicts.compare,
        "is_sequence": verdicts.is_sequence,
        "baseline": _reference(verdicts),
        "blocks_name": verdicts.blocks,
        "within": [
            {
                "axis": axis,
                "name": name,
                "labels": list(dict.fromkeys(group.labels[at] for group in verdicts.groups)),
                "texts": list(dict.fromkeys(group.labels[at] for group in named.groups)),
                "times": times_text(verdicts, at),
            }
            for at, (axis, name) in enumerate(zip(verdicts.within, named.within, strict=True))
        ],
        "methods": [
            {"label": str(method), "seconds": seconds.get(method)} for method in verdicts.methods
        ],
        "metrics": [
            {
                "name": metric.name,
                "unit": metric.unit,
                "better": metric.better,
                "ratio": metric.ratio,
            }
            for metric in overview.metrics[: excerpt.metrics]
        ],
        "groups": [
            {
                "labels": list(group.labels),
                "texts": list(shown.labels),
                "title": group_title(named, shown),
                **_numbers_of(group),
                **_blocks_of(overview, behind, excerpt.metrics, blocks, columns),
            }
            for group, shown, behind, blocks in zip(
                verdicts.groups, named.groups, overview.blocks, excerpt.blocks, strict=True
            )
        ],
        "shown_group": _shown_group(verdicts),
        "columns": {
            name: {"labels": [str(overview.columns[name][code]) for code in used.tolist()]}
            for name, used in columns.items()
        },
    }


def _reference(verdicts: Verdicts) -> str | None:
    """Return the method that the others are seen against at first."""
    label = verdicts.fallback if verdicts.baseline is None else verdicts.baseline
    return None if label is None else str(label)


def _shown_group(verdicts: Verdicts) -> int:
    """Return the group that charts of one group begin with, of those in sight with numbers.

    It is the first, or where groups are along numbers, such as lengths of gaps, the last.
    """
    axes, first = varying(verdicts), verdicts.groups[0].labels
    along = [
        at
        for at, group in enumerate(verdicts.groups)
        if all(group.labels[axis] == first[axis] for axis in axes[:-1])
    ]
    known = [at for at in along if verdicts.groups[at].known] or along
    return known[0 if any(isinstance(first[axis], str) for axis in axes[-1:]) else -1]


def _numbers_of(group: Verdict) -> dict[str, object]:
    other, mean = group.without_suspects, ("mean", "low", "high")
    return {
        **{name: _numbers(getattr(group, name)) for name in (*mean, "median", "rank")},
        "best": list(group.best) if group.marks else [],
        "tied": group.marked("tied"),
        "without_suspects": None
        if other is None
        else {
            **{name: _numbers(getattr(other, name)) for name in mean},
            "best": list(other.best) if other.marks else [],
            "tied": other.marked("tied"),
        },
    }


def _blocks_of(
    overview: Overview,
    behind: Blocks,
    metrics: int,
    blocks: NDArray[np.intp],
    columns: Mapping[str, NDArray[np.int64]],
) -> dict[str, object]:
    place = {block: at for at, block in enumerate(blocks.tolist())}
    errors, scales = {}, {}
    for metric in overview.metrics[:metrics]:
        errors[metric.name], scales[metric.name] = _codes(behind.errors[metric.name][blocks])
    rows = {
        name: _text(np.searchsorted(columns[name], codes[blocks]))
        for name, codes in behind.rows.items()
    }
    return {
        "all_blocks": len(behind.cluster),
        "suspects": len(behind.suspect),
        "cluster": _text(behind.cluster[blocks]),
        "rows": rows,
        "start": _numbers(behind.start[blocks]) if np.isfinite(behind.start).any() else None,
        "frames": _numbers(behind.frames[blocks]) if np.isfinite(behind.frames).any() else None,
        "suspect": {
            str(place[block]): reason for block, reason in behind.suspect.items() if block in place
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
