from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from nodegraph_files import sample_folder
from nodegraph_files.readers import read_model, read_recording, read_truth
from nodegraph_mocap import Trajectories
from nodegraph_synthesize.face import SyntheticFace
from nodegraph_synthesize.make_samples import GRID, SAMPLE_FACES, write_sample

COMPLETE = ("actor_a", "actor_b", "actor_c")
FLOAT32 = 2e-5  # mm; C3D holds single precision


@pytest.fixture(scope="module")
def synthesized() -> Callable[[str], SyntheticFace]:
    return cache(lambda name: SAMPLE_FACES[name]())


def test_the_samples_are_those_that_ship() -> None:
    assert {path.name for path in sample_folder("face").parent.iterdir()} == set(SAMPLE_FACES)


@pytest.mark.parametrize("name", SAMPLE_FACES)
def test_a_sample_is_what_the_generator_gives(
    synthesized: Callable[[str], SyntheticFace], name: str
) -> None:
    """To the grid, or to single precision: another processor may round otherwise."""
    face, path = synthesized(name), Path(f"sample:{name}")
    assert_close(
        read_recording(path=path), face.captured, GRID if name.startswith("face_") else FLOAT32
    )
    assert_close(read_truth(path=path), face.truth, GRID)
    model = read_model(path=path).model
    assert (model.names, model.markers) == (face.model.names, face.model.markers)
    np.testing.assert_allclose(model.neutral, face.model.neutral, rtol=0, atol=1e-9)
    np.testing.assert_allclose(model.shapes, face.model.shapes, rtol=0, atol=1e-9)


def assert_close(shipped: Trajectories, synthetic: Trajectories, tolerance: float) -> None:
    assert (shipped.markers, shipped.rate) == (synthetic.markers, synthetic.rate)
    assert shipped.marker_set == synthetic.marker_set
    np.testing.assert_array_equal(shipped.present, synthetic.present)
    np.testing.assert_allclose(
        shipped.positions, synthetic.positions, rtol=0, atol=tolerance, equal_nan=True
    )


@pytest.mark.parametrize("name", SAMPLE_FACES)
def test_the_faces_have_gaps_the_actors_none_and_only_the_first_impulses(
    synthesized: Callable[[str], SyntheticFace], name: str
) -> None:
    face = synthesized(name)
    missing = 1.0 - face.captured.present.mean()
    assert missing == 0.0 if name in COMPLETE else 0.04 < missing < 0.06
    assert face.impulses.hidden.any() == (name == "face")
    assert face.truth.present.all()


def test_writing_again_gives_the_same_bytes(
    synthesized: Callable[[str], SyntheticFace], tmp_path: Path
) -> None:
    for folder in (tmp_path / "one", tmp_path / "two"):
        write_sample(folder, synthesized("actor_a"), c3d=True)
    for path in (tmp_path / "one").iterdir():
        assert path.read_bytes() == (tmp_path / "two" / path.name).read_bytes()
