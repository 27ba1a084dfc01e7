"""A study of small sheets of numbers, to be locked and verified, and ways to change it."""

from __future__ import annotations

from pathlib import Path

NODES = """\
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from nodegraph import (
    Across, Files, InputFile, Kind, Refusal, Value, hookimpl, node
)

SHIFT = 1.0
SHADE = "grey"
ENDING = "!"


@dataclass(frozen=True)
class Sheet(Value):
    cells: np.ndarray
    names: tuple[str, ...]


@dataclass(frozen=True)
class Order(Value):
    means: dict[str, float]


class Drawing:
    def __init__(self, text):
        self.text = text


@node("read.sheet")
def read(*, path: InputFile) -> Sheet:
    with open("calls.txt", "a") as calls:
        calls.write("read ")
    # as bytes, which nobody watches: as unseen as the rounding of another processor
    cells = np.loadtxt(path) + float(os.environb.get(b"DRIFT", b"0"))
    return Sheet(cells, ("left", "middle", "right"))


@node("toy.cut")
def cut(sheet: Sheet, *, length: int = 3) -> Sheet:
    cells = sheet.cells.copy()
    cells[:length, 0] = np.nan
    return Sheet(cells, sheet.names)


@node("fill.mean")
def mean(sheet: Sheet) -> Sheet:
    return Sheet(np.where(np.isnan(sheet.cells), np.nanmean(sheet.cells), sheet.cells), sheet.names)


@node("fill.shift")
def shift(sheet: Sheet) -> Sheet:
    if np.isnan(sheet.cells).sum() > 8:
        raise Refusal(f"a gap of {float(np.isnan(sheet.cells).sum())} cells")
    return Sheet(np.where(np.isnan(sheet.cells), 1000.0 + SHIFT, sheet.cells), sheet.names)


@node("toy.rank")
def rank(sheets: Across[Sheet]) -> Order:
    fills = {str(at["fill"]) for at, _ in sheets}
    return Order({
        name: float(np.mean([one.cells for at, one in sheets if at["fill"] == name]))
        for name in sorted(fills)
    })


@node("toy.draw")
def draw(order: Order) -> Drawing:
    return Drawing(f"{SHADE}: {order.means}")


@node("toy.write")
def write(order: Order) -> Files:
    return Files({"order.txt": (", ".join(sorted(order.means)) + ENDING).encode()})


@hookimpl
def nodegraph_kinds():
    order = lambda one: [" < ".join(sorted(one.means, key=one.means.get))]
    numbers = lambda one: "fill,mean\\n" + "".join(
        f"{name},{value:.10g}\\n" for name, value in one.means.items()
    )
    return (
        Kind(Drawing, take_apart=lambda one: one.text, put_together=Drawing, faithful=False),
        Kind(Sheet, compare=lambda one, other: ()),
        Kind(Order, conclude=order, numbers=numbers),
    )
"""
GRAPH = """\
nodegraph: 1
title: A frozen toy
inputs: {file: numbers.txt}
axes: {length: [2, 5]}
nodes:
  sheet: {use: read.sheet, with: {path: $file}}
  cut: {use: toy.cut, in: sheet, with: {length: $length}}
  fill: {in: cut, alternatives: fill.*}
  order: {use: toy.rank, in: fill}
  picture: {use: toy.draw, in: order}
  written: {use: toy.write, in: order}
report: [order, picture]
"""
INNER = """\
nodegraph: 1
inputs: {sheet: Sheet}
nodes: {a: {use: fill.mean, in: $sheet}}
outputs: {sheet: a}
"""
OUTER = """\
nodegraph: 1
inputs: {file: numbers.txt}
nodes:
  sheet: {use: read.sheet, with: {path: $file}}
  cut: {use: toy.cut, in: sheet}
  fill: {use: inner.yaml, in: cut}
  shift: {use: fill.shift, in: fill}
"""
ROWS = 20


def write_study(nodes: str = NODES, graph: str = GRAPH) -> None:
    """Write the study into the working directory."""
    Path("study.py").write_text(nodes)
    Path("study.yaml").write_text(graph)
    write_numbers()


def write_numbers(path: str = "numbers.txt", first: float = 0.5) -> None:
    """Write the sheet that the study reads."""
    cells = [[first, 1.5, 2.5]] + [[row + 0.25, -row, row / 3] for row in range(1, ROWS)]
    Path(path).write_text("\n".join(" ".join(map(repr, row)) for row in cells))
