"""The values of a node in a finished run, found by labels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from nodegraph.errors import NodegraphError, nearest
from nodegraph.plan import Combination
from nodegraph.ports import Label

if TYPE_CHECKING:
    import pandas as pd

    from nodegraph.execute.results import Run


@dataclass(frozen=True, repr=False)
class Values:
    """The values of one output of a node, by labels; an empty port is each method's first."""

    run: Run
    node: str
    port: str

    def __repr__(self) -> str:
        name = f"{self.node}.{self.port}" if self.port else self.node
        along = f" along {', '.join(self.axes)}" if self.axes else ""
        return f"<Values of {name!r}: {len(self)}{along}>"

    @property
    def axes(self) -> tuple[str, ...]:
        """The node's axes."""
        return self.run.plan.graph.nodes[self.node].axes

    @property
    def value(self) -> Any:
        """The only value of a node that has one combination left.

        Raises
        ------
        NodegraphError
            If there are several combinations.
        """
        return self.at()

    def at(self, **labels: Label) -> Any:
        """Return the value at these labels; axes with one label may be left out.

        Raises
        ------
        NodegraphError
            If the labels do not name one combination that has a value.
        """
        for axis in labels:
            if axis not in self.axes:
                raise NodegraphError(
                    f"{self.node!r} has no axis {axis!r}; {nearest(axis, self.axes)}"
                )
        found = tuple(self._label(axis, labels) for axis in self.axes)
        cells = self.run.plan.cells[self.node]
        if found not in cells:
            raise NodegraphError(f"{self.node} at {found}: {self._skipped(found)}")
        return self._of(cells[found])

    def __iter__(self) -> Iterator[tuple[dict[str, Label], Any]]:
        return ((labels, self._of(index)) for labels, index in self._there())

    def frame(self) -> pd.DataFrame:
        """Return the values as one table, with a column for each axis."""
        from nodegraph.execute.frames import frame_of

        return frame_of(self)

    def shown(self) -> Iterator[tuple[dict[str, Label], Any]]:
        """Yield labels and values, or what is stored of values to be shown."""
        for labels, index in self._there():
            yield labels, self.run.shown_of(index)[self._position(index)]

    def __len__(self) -> int:
        return len(self.run.plan.cells[self.node])

    def _there(self) -> Iterator[tuple[dict[str, Label], int]]:
        for combination, index in self.run.plan.cells[self.node].items():
            if self.run.outcomes[index].state in ("done", "unneeded"):
                yield dict(zip(self.axes, combination, strict=True)), index

    def _of(self, index: int) -> Any:
        return self.run.values_of(index)[self._position(index)]

    def _position(self, index: int) -> int:
        """Return which output of a step is meant: by its name, because methods may order theirs."""
        names = [one.name for one in self.run.plan.steps[index].method.node.outputs]
        return names.index(self.port) if self.port else 0

    def _label(self, axis: str, labels: Mapping[str, Label]) -> Label:
        there = self.run.plan.graph.axes[axis].labels
        if axis not in labels:
            if len(there) == 1:
                return there[0]
            raise NodegraphError(
                f"{self.node!r} has several values along {axis!r}; {nearest('', there)}"
            )
        if labels[axis] not in there:
            raise NodegraphError(
                f"{axis!r} has no label {labels[axis]!r}; {nearest(labels[axis], there)}"
            )
        return labels[axis]

    def _skipped(self, combination: Combination) -> str:
        return self.run.plan.skipped[self.node].get(combination, "there is no such combination")
