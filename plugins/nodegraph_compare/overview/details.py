"""How single blocks look: which of them a page holds, and where their labels lie."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import json_script

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from nodegraph import Detail, Label, Origin
    from nodegraph_compare.overview.pack import Excerpt
    from nodegraph_compare.overview.value import Overview

_MOST_BYTES = 500_000
_MOST_READ = 150
"""Inputs of scores that are read while a page is written."""

_AT_RANDOM = 40
"""Blocks of each group that are tried: those in combinations that were read anyway are shown."""


@dataclass(frozen=True)
class Details:
    """What the views of single blocks add to a page.

    Attributes
    ----------
    data : mapping
        Entries of the overview's data: ``layout``, where the labels of a column lie; ``detail``,
        the module that shows a block and the ids of those that are packed, by
        ``group/block``; ``suggested`` blocks; ``command`` that computes the step behind a block,
        with its labels in braces.
    html : str
        Elements that hold the packed blocks.
    scripts, styles : tuple of str
        Of the views.
    """

    data: Mapping[str, Any]
    html: str = ""
    scripts: tuple[str, ...] = ()
    styles: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Candidate:
    """A block by its group and its place in the page, and why it is worth a look, if it is."""

    group: int
    block: int
    why: str = ""


def details_of(overview: Overview, excerpt: Excerpt, origin: Origin) -> Details:
    """Return the views of some blocks, within a budget: those that are worth a look first.

    Of each group these are the suspect block with the largest error, the worst and a typical one
    of the best method, one in which methods differ most, and one at random. Recordings of few
    combinations are read; of the others, what lies in these is taken.

    Parameters
    ----------
    overview
        The comparison.
    excerpt
        The blocks that the page holds.
    origin
        Of the run.
    """
    takes = _Takes(overview, excerpt, origin)
    data: dict[str, Any] = {
        "layout": None, "detail": None, "suggested": [], "command": takes.command(),
    }  # fmt: skip
    wanted = [list(_worth_a_look(overview, excerpt, at)) for at in range(len(overview.groups))]
    detail = takes.detail(next((each[0] for each in wanted if each), None))
    if detail is None:
        return Details(data)
    elements: list[str] = []
    ids: dict[str, str] = {}
    size = 0
    layout = None
    # by rank, then by group: every group has its first before any has its second
    for _, candidate in sorted(
        ((place, each) for several in wanted for place, each in enumerate(several)),
        key=lambda item: item[0],
    ):
        if size > _MOST_BYTES:
            break
        key = f"{candidate.group}/{candidate.block}"
        inputs = None if key in ids else takes.read(candidate)
        if inputs is None:
            continue
        if layout is None:
            layout = _layout(detail, overview, next(iter(inputs.values())))
        view = detail.pack(takes.block(candidate), inputs)
        if view is None:
            continue
        ids[key] = f"overview-{origin.node}-{len(elements)}"
        elements.append(json_script(view, ids[key]))
        size += len(elements[-1])
        if candidate.why:
            data["suggested"].append(
                {"group": candidate.group, "block": candidate.block, "why": candidate.why}
            )
    data |= {"layout": layout, "detail": {"module": detail.module, "packed": ids}}
    return Details(data, "".join(elements), detail.scripts, detail.styles)


def _layout(detail: Detail, overview: Overview, inputs: Mapping[str, Any]) -> dict[str, Any] | None:
    for column in overview.columns:
        layout = detail.layout(inputs, column)
        if layout is not None:
            return {**layout, "column": column}
    return None


def _worth_a_look(overview: Overview, excerpt: Excerpt, at: int) -> Iterator[_Candidate]:
    """Yield blocks of a group, those that a reader asks for first at the front."""
    group = overview.groups[at]
    blocks = excerpt.blocks[at]
    errors = group.errors[overview.metric.name][blocks].astype(np.float64)
    known = np.asarray(np.isfinite(errors).any(axis=1))
    if not known.any():
        return
    order: dict[int, str] = {}
    best = group.best[0] if group.best else int(np.argmax(np.isfinite(errors).any(axis=0)))
    name = overview.methods[best]
    own = np.where(np.isfinite(errors[:, best]), errors[:, best], np.nan)
    least = np.where(known, np.nanmin(np.where(known[:, None], errors, 0.0), axis=1), -np.inf)
    suspect = np.isin(blocks, [*group.suspect])
    if suspect.any():
        order[int(np.argmax(np.where(suspect, least, -np.inf)))] = "suspect"
    if np.isfinite(own).any():
        worst = np.nanargmin(own) if overview.metric.better == "higher" else np.nanargmax(own)
        order.setdefault(int(worst), f"worst for {name}")
    spread = _spread(errors)
    if np.isfinite(spread).any():
        order.setdefault(int(np.nanargmax(spread)), "methods differ most")
    if np.isfinite(own).any():
        typical = int(np.nanargmin(np.abs(own - np.nanmedian(own))))
        order.setdefault(typical, f"typical for {name}")
    random = np.random.default_rng(at).permutation(np.flatnonzero(known))
    for place, block in enumerate(random[:_AT_RANDOM].tolist()):
        order.setdefault(int(block), "" if place else "at random")
    for block, why in order.items():
        yield _Candidate(at, block, why)


def _spread(errors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (B,) how far the largest error of a block is above the median of its methods."""
    several = np.isfinite(errors).sum(axis=1) > 1
    spread = np.full(len(errors), np.nan)
    rows = np.where(np.isfinite(errors), errors, np.nan)[several]
    spread[several] = np.nanmax(rows, axis=1) - np.nanmedian(rows, axis=1)
    return spread


class _Takes:
    """The inputs of scores, as the run has them; those of one combination are read once."""

    def __init__(self, overview: Overview, excerpt: Excerpt, origin: Origin) -> None:
        self._overview, self._excerpt, self._origin = overview, excerpt, origin
        self._inputs: dict[str, dict[str, Mapping[str, Any]] | None] = {}
        self._read = 0

    def labels(self, candidate: _Candidate) -> dict[str, Label]:
        """Return what is known of a block: labels of its group and of the block itself."""
        overview, group = self._overview, self._overview.groups[candidate.group]
        block = int(self._excerpt.blocks[candidate.group][candidate.block])
        return dict(zip(overview.within, group.labels, strict=True)) | {
            name: overview.columns[name][codes[block]] for name, codes in group.rows.items()
        }

    def block(self, candidate: _Candidate) -> dict[str, Any]:
        """Return the labels of a block for its view, and its frames where they are known."""
        group = self._overview.groups[candidate.group]
        place = self._excerpt.blocks[candidate.group][candidate.block]
        when = {"start": group.start[place], "frames": group.frames[place]}
        known = {name: int(frame) for name, frame in when.items() if np.isfinite(frame)}
        return self.labels(candidate) | known

    def detail(self, candidate: _Candidate | None) -> Detail | None:
        """Return what shows blocks of the inputs that scores read; None if nothing does."""
        if candidate is None or not self._overview.compare:
            return None
        inputs = self.read(candidate)
        first = next(iter(next(iter(inputs.values())).values()), None) if inputs else None
        return next(
            (detail for detail in self._origin.details if isinstance(first, detail.type)), None
        )

    def read(self, candidate: _Candidate) -> dict[str, Mapping[str, Any]] | None:
        """Return what the score of each method had read; None where that is not at hand."""
        labels = self.labels(candidate)
        methods = self._overview.methods
        key = self._command(labels, methods[0])
        if key not in self._inputs:
            if self._read + len(methods) > max(_MOST_READ, len(methods)):
                return None
            self._read += len(methods)
            read = {
                str(method): inputs
                for method in methods
                if (inputs := self._origin.inputs(labels | {self._overview.compare: method}))
            }
            self._inputs[key] = read or None
        return self._inputs[key]

    def command(self) -> dict[str, Any] | None:
        """Return the command for the step behind a block, each label in it as ``{axis}``."""
        groups = self._overview.groups
        first = next((at for at, group in enumerate(groups) if len(group.unit)), None)
        if first is None:
            return None
        labels = self.labels(_Candidate(first, 0))
        text = self._command(labels, self._overview.methods[0])
        labels |= {self._overview.compare: self._overview.methods[0]}
        axes = []
        for name, label in labels.items():
            pattern = rf"(?<=\s){re.escape(f'{name}={label}')}(?=\s|$)"
            replaced = re.sub(pattern, f"{name}={{{name}}}", text)
            axes += [name] if replaced != text else []
            text = replaced
        return {"text": text, "axes": axes} if text else None

    def _command(self, labels: Mapping[str, Label], method: Label) -> str:
        return self._origin.command({**labels, self._overview.compare: method})
