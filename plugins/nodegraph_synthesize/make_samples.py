"""Write the recordings that come with the package: ``python -m nodegraph_synthesize.make_samples``.

Each sample is a folder with a recording (C3D), its marker set (YAML) and the blendshape model of
the actor (NPZ), from which each reader takes its file.
"""

from __future__ import annotations

from pathlib import Path

import nodegraph_mocap
from nodegraph_files import model_bytes
from nodegraph_files.c3d import write_c3d
from nodegraph_files.marker_set import marker_set_text
from nodegraph_synthesize.face import SyntheticFace, synthesize_face

FOLDER = Path(nodegraph_mocap.__file__).parent / "samples"


def made_samples() -> dict[str, SyntheticFace]:
    """Return what each sample is made from: a damaged face, and three complete actors."""
    return {
        "face": synthesize_face(),
        "actor_a": _complete(seed=1),
        "actor_b": _complete(seed=2),
        "actor_c": _complete(seed=3),
    }


def write_sample(folder: Path, face: SyntheticFace) -> None:
    """Write one sample's files into a folder, which is made if need be."""
    folder.mkdir(parents=True, exist_ok=True)
    write_c3d(face.captured, folder / "recording.c3d")
    (folder / "markers.yaml").write_text(marker_set_text(face.marker_set), encoding="utf-8")
    (folder / "model.npz").write_bytes(model_bytes(face.model))


def main() -> None:
    """Write every sample."""
    for name, face in made_samples().items():
        write_sample(FOLDER / name, face)
        print(f"{name}: {FOLDER / name}")


def _complete(*, seed: int) -> SyntheticFace:
    return synthesize_face(noise=0.05, missing=0.0, impulses=0.0, seed=seed)


if __name__ == "__main__":
    main()
