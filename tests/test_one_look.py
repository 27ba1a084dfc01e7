"""A recording has one colour in all figures of a graph, whichever others lie over it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.colors import to_hex

import nodegraph as ng

GRAPH = """
nodegraph: 1
title: Do figures agree?
axes: {trial: [0, 1, 2]}
nodes:
  face: {use: synthesize.face, with: {seconds: 2, markers: 20, missing: 0, impulses: 0}}
  gaps: {use: gaps.cut, in: face.captured, with: {length: 5, count: 4, seed: $trial}}
  fill: {in: gaps.gappy, alternatives: [fill.cubic, fill.guenter, fill.linear, fill.muscle]}
  four: {use: plot.spectra, in: {recordings: {from: fill, at: {trial: 0}}}}
  two:
    use: plot.spectra
    in:
      recordings:
        muscle: {from: fill, at: {fill: muscle, trial: 0}}
        guenter: {from: fill, at: {fill: guenter, trial: 0}}
report: [four, two]
"""


def colours(figure: Any) -> dict[str, str]:
    """Return the colour of every label that a figure draws."""
    (axis,) = figure.axes
    handles, labels = axis.get_legend_handles_labels()
    return {name: to_hex(line.get_color()) for name, line in zip(labels, handles, strict=True)}


def test_what_is_drawn_of_some_looks_as_it_does_among_all(tmp_path: Path) -> None:
    path = tmp_path / "graph.yaml"
    path.write_text(GRAPH)
    run = ng.run(path, store=None)
    every, some = colours(run["four"].value), colours(run["two"].value)
    assert len(set(every.values())) == len(every) == 4
    assert some == {name: every[name] for name in ("muscle", "guenter")}
