"""Numbers on their way into a GLB file: their bytes, and what says how they lie there.

Source: glTF 2.0 Specification, section 3.6 (Binary Data Storage), The Khronos Group.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FLOAT, _UNSIGNED = 5126, 5125
_KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
_VERTICES, _CORNERS = 34962, 34963


class GlbBuffer:
    """Gathers arrays, each in a buffer view and an accessor of its own."""

    def __init__(self) -> None:
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, Any]] = []
        self._content = bytearray()

    @property
    def content(self) -> bytes:
        """The bytes so far."""
        return bytes(self._content)

    def vertices(self, positions: NDArray[np.float64], what: str) -> int:
        """Add (V, 3) positions or offsets of vertices; return the accessor's number."""
        return self._floats(positions, what, bounds=True, target=_VERTICES)

    def directions(self, vectors: NDArray[np.float64], what: str) -> int:
        """Add (V, 3) normals of vertices, or offsets of them; return the accessor's number."""
        return self._floats(vectors, what, bounds=False, target=_VERTICES)

    def corners(self, faces: NDArray[np.int64]) -> int:
        """Add (F, 3) triangles; return the accessor's number."""
        return self._add(faces.astype("<u4").reshape(-1, 1), _UNSIGNED, target=_CORNERS)

    def keys(self, values: NDArray[np.float64], what: str, *, bounds: bool = False) -> int:
        """Add (N, width) numbers of an animation; return the accessor's number."""
        return self._floats(values, what, bounds=bounds)

    def _floats(
        self, values: NDArray[np.float64], what: str, *, bounds: bool, target: int | None = None
    ) -> int:
        with np.errstate(over="ignore"):
            stored = values.astype("<f4")
        if not np.isfinite(stored).all():
            raise ValueError(f"{what}: {np.abs(values).max():.3g} is too large for a GLB file")
        return self._add(stored, _FLOAT, target=target, bounds=bounds)

    def _add(
        self, stored: NDArray[Any], component: int, *, target: int | None, bounds: bool = False
    ) -> int:
        view = {"buffer": 0, "byteOffset": len(self._content), "byteLength": stored.nbytes}
        self.views.append(view if target is None else {**view, "target": target})
        self._content += stored.tobytes()
        accessor = {
            "bufferView": len(self.views) - 1,
            "componentType": component,
            "count": len(stored),
            "type": _KINDS[stored.shape[1]],
        }
        if bounds:
            accessor |= {
                "min": stored.min(axis=0).tolist(),
                "max": stored.max(axis=0).tolist(),
            }
        self.accessors.append(accessor)
        return len(self.accessors) - 1
