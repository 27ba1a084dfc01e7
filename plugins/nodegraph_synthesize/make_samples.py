"""Write the recordings that come with the package: ``python -m nodegraph_synthesize.make_samples``.

Each sample is a folder with a recording (C3D or NPZ), the same without noise, impulses and gaps
(``truth.npz``), its marker set (YAML) and the blendshape model of the actor (NPZ), from which each
reader takes its file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_files import model_bytes, npz_bytes
from nodegraph_files.c3d import write_c3d
from nodegraph_files.marker_set import marker_set_text
from nodegraph_files.paths import SAMPLES
from nodegraph_synthesize.face import SyntheticFace, synthesize_face

if TYPE_CHECKING:
    from collections.abc import Callable

    from nodegraph_mocap import Trajectories

_SEEDS = (11, 12, 13, 21, 15, 16, 24, 18)
"""Of the faces of the studies, ``face_1`` and so on: no two are so alike that studies take them for
one person's."""
GRID = 1.0 / 256.0
"""mm, of the positions in NPZ: trailing zero bits compress."""

_complete = partial(synthesize_face, noise=0.05, missing=0.0, impulses=0.0)
_published = partial(synthesize_face, seconds=12.0, noise=0.03, noise_cutoff=8.0, impulses=0.0)

SAMPLE_FACES: Mapping[str, Callable[[], SyntheticFace]] = {
    "face": synthesize_face,
    **{f"actor_{name}": partial(_complete, seed=seed) for seed, name in enumerate("abc", start=1)},
    **{
        f"face_{number}": partial(_published, seed=seed)
        for number, seed in enumerate(_SEEDS, start=1)
    },
}
"""What makes each sample: a damaged face, three complete ones, and the eight of the studies.

The eight have gaps, and otherwise what a low-pass at 8 Hz leaves of a recording: little noise, and
no impulses.
"""


def write_sample(folder: Path, face: SyntheticFace, *, c3d: bool) -> None:
    """Write one sample's files into a folder, which is created if need be."""
    folder.mkdir(parents=True, exist_ok=True)
    if c3d:
        write_c3d(face.captured, folder / "recording.c3d")
    else:
        (folder / "recording.npz").write_bytes(npz_bytes(_on_grid(face.captured)))
    (folder / "truth.npz").write_bytes(npz_bytes(_on_grid(face.truth)))
    (folder / "markers.yaml").write_text(marker_set_text(face.marker_set), encoding="utf-8")
    (folder / "model.npz").write_bytes(model_bytes(face.model))


def main() -> None:
    """Write every sample."""
    for name, synthesize in SAMPLE_FACES.items():
        write_sample(SAMPLES / name, synthesize(), c3d=not name.startswith("face_"))
        print(f"{name}: {SAMPLES / name}")


def _on_grid(recording: Trajectories) -> Trajectories:
    return replace(recording, positions=np.round(recording.positions / GRID) * GRID)


if __name__ == "__main__":
    main()
