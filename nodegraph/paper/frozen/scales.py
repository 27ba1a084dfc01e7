"""The usual sizes of the numbers in results, by which differences are measured."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from statistics import median

from nodegraph.execute import Run
from nodegraph.paper.frozen.results import Cell, Results
from nodegraph.paper.frozen.sketch import FLOOR, Sketch


def scales(cells: Iterable[Cell], results: Results, run: Run) -> dict[str, dict[str, float]]:
    """Return the usual size of the floats at each place of the values of each group.

    It is the median over the combinations; but no less than a thousandth of what the values are
    made of, because the difference of two large numbers has the rounding of those.

    Parameters
    ----------
    cells
        In the order of the graph.
    results
    run
    """
    grouped: dict[str, list[int]] = {}
    for cell in cells:
        if not results.ended(cell.index):
            grouped.setdefault(cell.group, []).append(cell.index)
    above: dict[int, float] = {}
    found: dict[str, dict[str, float]] = {}
    for group, steps in grouped.items():
        fed = (above.get(one, 0.0) for step in steps for one in run.plan.steps[step].needed)
        largest = max(fed, default=0.0)
        usual = _usual(results.sketch(one) for one in steps)
        found[group] = {
            place: min(float(f"{max(size, FLOOR * largest) or 1.0:.4g}"), sys.float_info.max)
            for place, size in usual.items()
        }
        above |= dict.fromkeys(steps, max([largest, *usual.values()]))
    return found


def _usual(sketches: Iterable[Sketch | None]) -> dict[str, float]:
    sizes: dict[str, list[float]] = {}
    for one in sketches:
        for place, leaf in one.leaves.items() if one is not None else ():
            sizes.setdefault(place, []).append(leaf.size)
    # the halves have a mean that does not overflow, and of all but the smallest the same digits
    halves = {place: [one / 2.0 for one in all_ if one] for place, all_ in sizes.items()}
    return {place: 2.0 * median(found or [0.0]) for place, found in halves.items()}
