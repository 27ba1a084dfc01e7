"""A head as its file gives it: in the file's own unit, with its markers if it names any."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.head import Head

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class RawHead:
    """What a reader of heads returns.

    Attributes
    ----------
    vertices : (V, 3) array of float64
    faces : (F, 3) array of int64
    morphs : mapping of name to (V, 3) array of float64
        Offsets of the vertices at weight 1.
    unit : str
        Of length.
    unit_stated : bool
        Whether this file says so, and not only its form or a habit.
    marker_vertices : mapping of marker to vertex
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    morphs: Mapping[str, NDArray[np.float64]]
    unit: str
    unit_stated: bool = False
    marker_vertices: Mapping[str, int] = field(default_factory=dict)

    @property
    def extent(self) -> float:
        """The longest side, along an axis."""
        return float(np.ptp(self.vertices, axis=0).max())

    def head(self, millimetres: float) -> Head:
        """Return the head in millimetres, of which the unit is that many."""
        offsets = list(self.morphs.values()) or np.zeros((0, *self.vertices.shape))
        return Head(
            vertices=self.vertices * millimetres,
            faces=self.faces,
            morphs=np.asarray(offsets) * millimetres,
            names=tuple(self.morphs),
            markers=tuple(self.marker_vertices),
            marker_vertices=np.array(list(self.marker_vertices.values()), dtype=np.int64),
        )
