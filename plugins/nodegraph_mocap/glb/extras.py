"""What GLB files of heads say beyond glTF, in the places that it leaves free."""

from __future__ import annotations

TARGET_NAMES = "targetNames"
"""In the extras of a mesh: the names of its morph targets, as most programs write them."""

MARKER_VERTICES = "markerVertices"
"""In the extras of a mesh, our own: the vertex of each marker."""

UNIT = "m"
"""That of glTF. Ours have it in the extras of the asset, as ``unit``: not all files keep to it."""
