"""Views of single blocks: which of them a page holds, and where their labels lie."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import json_script
from nodegraph_compare.question import sign_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from nodegraph import Detail, Label, Provenance
    from nodegraph_compare.overview.pack import Excerpt
    from nodegraph_compare.overview.value import Overview

_MOST_BYTES = 500_000
_FEWEST_PLACES = 3
_MOST_READ = 150
"""Inputs of scores that are read while a page is written."""

_AT_RANDOM = 40
"""Blocks of each group that are tried: those in combinations that were read anyway are shown."""


@dataclass(frozen=True)
class Details:
    """The parts of a page that views of single blocks add.

    Attributes
    ----------
    data : mapping
        Entries of the overview's data: ``layout``, where the labels of a column lie; ``detail``,
        the module that shows a block and the ids of those that are packed, by
        ``group/block``; ``suggested`` blocks; ``command`` that computes the step behind a block,
        with its labels in braces; ``members``, the axes that a block averages over and their
        labels, of which the first are packed.
    html : str
        Elements that hold the packed blocks.
    scripts, styles : tuple of str
        Of the views.
    """

    data: Mapping[str, object]
    html: str = ""
    scripts: tuple[str, ...] = ()
    styles: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Kind:
    """Blocks of a group that are worth a look, by their places in the page: one of them is shown.

    The first is the best example of what `why` says; it is empty for blocks that nothing marks.
    """

    why: str
    blocks: tuple[int, ...]


def details_of(overview: Overview, excerpt: Excerpt, origin: Provenance) -> Details:
    """Return the views of some blocks, within a budget: those that are worth a look first.

    Of each group these are the suspect block with the largest error, the worst and a typical one
    of the best method, one in which methods differ most, the worst of every other method, and some
    at random. Recordings of few combinations are read; of the others, what lies in these is taken.

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
        "members": [{"name": axis, "labels": [*of]} for axis, of in takes.members.items()],
    }  # fmt: skip
    wanted = [list(_worth_a_look(overview, excerpt, at)) for at in range(len(overview.blocks))]
    first = next((at for at, kinds in enumerate(wanted) if kinds), None)
    detail = None if first is None else takes.detail(first, wanted[first][0].blocks[0])
    if detail is None:
        return Details(data)
    elements: list[str] = []
    ids: dict[str, str] = {}
    size = 0
    layout = None
    # every group has its first before any has its second
    for several in zip_longest(*wanted, fillvalue=_Kind("", ())):
        for at, kind in enumerate(several):
            fresh = (block for block in kind.blocks if f"{at}/{block}" not in ids)
            read = ((block, takes.read(at, block)) for block in fresh)
            block, inputs = next(((b, i) for b, i in read if i is not None), (0, None))
            if inputs is None or size > _MOST_BYTES:
                continue
            view = detail.pack(takes.block(at, block), inputs)
            if view is None:
                continue
            if layout is None:
                layout = _layout(detail, overview, next(iter(inputs.values())))
            name = ids[f"{at}/{block}"] = f"overview-{origin.node}-{len(elements)}"
            elements.append(json_script(view, name))
            size += len(elements[-1])
            if kind.why:
                data["suggested"].append({"group": at, "block": block, "why": kind.why})
    data |= {"layout": layout, "detail": {"module": detail.module, "packed": ids}}
    return Details(data, "".join(elements), detail.scripts, detail.styles)


def _layout(
    detail: Detail, overview: Overview, inputs: Mapping[str, object]
) -> dict[str, object] | None:
    for column, labels in overview.columns.items():
        layout = detail.layout(inputs, column) if len(labels) >= _FEWEST_PLACES else None
        if layout is not None:
            return {**layout, "column": column}
    return None


def _worth_a_look(overview: Overview, excerpt: Excerpt, at: int) -> Iterator[_Kind]:
    """Yield blocks of a group, those that a reader asks for first at the front."""
    verdicts, behind = overview.verdicts, overview.blocks[at]
    blocks = excerpt.blocks[at]
    errors = behind.errors[verdicts.metric.name][blocks].astype(np.float64)
    known = np.flatnonzero(np.isfinite(errors).any(axis=1))
    if not len(known):
        return
    leaders = verdicts.groups[at].best
    best = leaders[0] if leaders else int(np.argmax(np.isfinite(errors).any(axis=0)))
    name = verdicts.methods[best]
    least = np.fmin.reduce(errors, axis=1)
    suspect = known[np.isin(blocks[known], [*behind.suspect])]
    own = errors[:, best]
    solved = known[np.isfinite(own[known])]
    sign = sign_of(verdicts.metric.better)
    if len(suspect):
        yield _Kind("suspect", _first(suspect, -least, len(suspect)))
    if len(solved):
        yield _Kind(f"worst for {name}", _first(solved, -sign * own, 1))
    yield _Kind("methods differ most", _first(known, -_spread(errors), 1))
    if len(solved):
        middle = np.abs(own - np.median(own[solved]))
        yield _Kind(f"typical for {name}", _first(solved, middle, len(solved) // 3 + 1))
    for place in np.flatnonzero(np.isfinite(errors).any(axis=0)).tolist():
        own = errors[:, place]
        yield _Kind("", _first(known[np.isfinite(own[known])], -sign * own, 1))
    random = np.random.default_rng(at).permutation(known)[:_AT_RANDOM].tolist()
    yield _Kind("at random", tuple(random))
    for block in random:
        yield _Kind("", (block,))


def _first(places: NDArray[np.intp], values: NDArray[np.float64], count: int) -> tuple[int, ...]:
    """Return the places of the smallest values, the smallest first."""
    order = np.argsort(values[places], kind="stable")[:count]
    return tuple(places[order].tolist())


def _spread(errors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (B,) the largest error of each block, less the median of its methods."""
    several = np.isfinite(errors).any(axis=1)
    spread = np.zeros(len(errors))
    spread[several] = np.nanmax(errors[several], axis=1) - np.nanmedian(errors[several], axis=1)
    return spread


class _Takes:
    """The inputs of scores, as the run has them; those of one combination are read once."""

    def __init__(self, overview: Overview, excerpt: Excerpt, origin: Provenance) -> None:
        self._overview, self._excerpt, self._origin = overview, excerpt, origin
        self._inputs: dict[str, dict[str, Mapping[str, object]] | None] = {}
        self._read = 0
        named = (*overview.verdicts.within, *overview.columns, overview.verdicts.compare)
        self.members = origin.open_axes(dict.fromkeys(named))

    def labels(self, at: int, block: int) -> dict[str, Label]:
        """Return what is known of a block: labels of its group, its own, and its first member's."""
        overview, verdicts = self._overview, self._overview.verdicts
        place = int(self._excerpt.blocks[at][block])
        rows = overview.blocks[at].rows
        own = {name: overview.columns[name][codes[place]] for name, codes in rows.items()}
        first = {axis: labels[0] for axis, labels in self.members.items()}
        of_group = zip(verdicts.within, verdicts.groups[at].labels, strict=True)
        return {**first, **dict(of_group), **own}

    def block(self, at: int, block: int) -> dict[str, Any]:
        """Return the labels of a block for its view, and its frames where they are known."""
        blocks = self._overview.blocks[at]
        place = self._excerpt.blocks[at][block]
        when = {"start": blocks.start[place], "frames": blocks.frames[place]}
        known = {name: int(frame) for name, frame in when.items() if np.isfinite(frame)}
        return self.labels(at, block) | known

    def detail(self, at: int, block: int) -> Detail | None:
        """Return what shows blocks of the inputs that scores read; None if nothing does."""
        if not self._overview.verdicts.compare:
            return None
        inputs = self.read(at, block)
        first = next(iter(next(iter(inputs.values())).values()), None) if inputs else None
        return None if first is None else self._origin.detail(first)

    def read(self, at: int, block: int) -> dict[str, Mapping[str, object]] | None:
        """Return what the score of each method had read; None where that is not available."""
        labels = self.labels(at, block)
        methods = self._overview.verdicts.methods
        key = self._command(labels, methods[0])
        if key not in self._inputs:
            if self._read + len(methods) > max(_MOST_READ, len(methods)):
                return None
            self._read += len(methods)
            compare = self._overview.verdicts.compare
            read = {
                str(method): inputs
                for method in methods
                if (inputs := self._origin.inputs(labels | {compare: method}))
            }
            self._inputs[key] = read or None
        return self._inputs[key]

    def command(self) -> dict[str, object] | None:
        """Return the command for the step behind a block, each label in it as ``{axis}``."""
        behind = self._overview.blocks
        first = next((at for at, blocks in enumerate(behind) if len(blocks.cluster)), None)
        if first is None:
            return None
        labels = self.labels(first, 0)
        text = self._command(labels, self._overview.verdicts.methods[0])
        labels |= {self._overview.verdicts.compare: self._overview.verdicts.methods[0]}
        axes = []
        for name, label in labels.items():
            pattern = rf"(?<=\s){re.escape(f'{name}={label}')}(?=\s|$)"
            replaced = re.sub(pattern, f"{name}={{{name}}}", text)
            axes += [name] if replaced != text else []
            text = replaced
        return {"text": text, "axes": axes} if text else None

    def _command(self, labels: Mapping[str, Label], method: Label) -> str:
        return self._origin.command({**labels, self._overview.verdicts.compare: method})
