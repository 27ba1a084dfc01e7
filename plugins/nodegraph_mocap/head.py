"""Heads: a mesh with named morph targets, and which of its vertices carry markers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Value
from nodegraph_mocap.checks import distinct, finite, indices, set_fields
from nodegraph_mocap.face_model import BlendshapeModel

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Head(Value):
    """A head's mesh at rest and its morph targets.

    Attributes
    ----------
    vertices : (V, 3) array of float64
        Millimetres.
    faces : (F, 3) array of int64
        Vertices of each triangle, counter-clockwise as seen from outside.
    morphs : (K, V, 3) array of float64
        Offsets of the vertices at weight 1, millimetres.
    names : tuple of K str
        Names of the morph targets; the same weights drive a `BlendshapeModel` of these names.
    markers : tuple of M str
    marker_vertices : (M,) array of int64
        The vertex that each marker sits on.

    Raises
    ------
    ValueError
        If shapes disagree, a number is missing or infinite, a name is listed twice, or a vertex
        is named that the mesh does not have.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    morphs: NDArray[np.float64]
    names: tuple[str, ...]
    markers: tuple[str, ...]
    marker_vertices: NDArray[np.int64]

    def __post_init__(self) -> None:
        names = distinct("morph targets", self.names)
        markers = distinct("markers", self.markers)
        vertices = finite("vertices", self.vertices, ("vertices", 3))
        count = len(vertices)
        set_fields(
            self,
            vertices=vertices,
            faces=indices("faces", self.faces, ("triangles", 3), count=count),
            morphs=finite("morphs", self.morphs, (len(names), count, 3)),
            names=names,
            markers=markers,
            marker_vertices=indices(
                "marker vertices", self.marker_vertices, (len(markers),), count=count
            ),
        )

    @property
    def model(self) -> BlendshapeModel:
        """The morph targets where the markers sit."""
        return BlendshapeModel(
            neutral=self.vertices[self.marker_vertices],
            shapes=self.morphs[:, self.marker_vertices],
            names=self.names,
            markers=self.markers,
        )
