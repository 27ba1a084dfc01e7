"""Running numbers: kept current in every frame of a stream, such as the error so far."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from html import escape
from io import StringIO
from typing import TYPE_CHECKING

import numpy as np

from nodegraph.node.live_form import RunningForm, RunningState
from nodegraph.plugin.hook_types import Rendered
from nodegraph.plugin.kind import Kind
from nodegraph.plugin.streaming import Frame, Streamable

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class RunningNumbers:
    """The results of a `RunningForm` on a stream, frame by frame.

    Attributes
    ----------
    units : mapping of name to unit
        Empty for a count.
    values : (T, K) array of float64
        After each frame, in the order of the names; NaN where nothing is known.
    """

    units: Mapping[str, str]
    values: NDArray[np.float64]

    @property
    def columns(self) -> list[str]:
        """Names with units: ``rmse (mm)``."""
        return [f"{name} ({unit})" if unit else name for name, unit in self.units.items()]


class RunningStream:
    """A `RunningForm` at work, as a `LiveState`."""

    def __init__(self, form: RunningForm, state: RunningState) -> None:
        self.header = RunningNumbers(form.numbers, np.empty((0, len(form.numbers))))
        self.push = state.push

    def drain(self) -> tuple[()]:
        """Return nothing: it is never behind."""
        return ()


class Latest:
    """The numbers of a step after the last frame.

    Attributes
    ----------
    header : RunningNumbers
        Without frames.
    """

    def __init__(self, units: Mapping[str, str]) -> None:
        self.header = RunningNumbers(units, np.empty((0, len(units))))
        self._values = np.full(len(units), np.nan)

    def receive(self, frame: Frame) -> None:
        """Take the numbers of the next frame."""
        self._values = frame.payload

    def as_json(self) -> dict[str, float | None]:
        """Return each by its name, None for one that is not known."""
        values = self._values.tolist()
        return {
            name: value if math.isfinite(value) else None
            for name, value in zip(self.header.units, values, strict=True)
        }


_STREAM = Streamable(
    header=lambda numbers: replace(numbers, values=numbers.values[:0]),
    split=lambda numbers: list(numbers.values),
    join=lambda header, rows: replace(header, values=np.stack(rows)) if rows else header,
    missing=lambda header: np.full(len(header.units), np.nan),
)


def _render(numbers: RunningNumbers, title: str) -> Rendered:
    """Return a file with a row per frame, and the last row as text."""
    file = StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["frame", *numbers.columns])
    for frame, row in enumerate(numbers.values.tolist()):
        writer.writerow([frame, *("" if math.isnan(value) else value for value in row)])
    last = numbers.values[-1:].ravel().tolist()  # nothing of a stream without frames
    texts = zip(numbers.columns, last, strict=False)
    text = ", ".join(f"{column} {value:.4g}" for column, value in texts)
    content = file.getvalue().encode()
    return Rendered(html=f"<p>{escape(text)}</p>", text=text, files={".csv": content})


KIND = Kind(RunningNumbers, render=_render, stream=lambda: _STREAM)
