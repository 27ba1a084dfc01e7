from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from nodegraph_files import sample_folder
from nodegraph_files.c3d import read_c3d
from nodegraph_files.marker_set import read_marker_set_yaml
from nodegraph_synthesize.face import SyntheticFace
from nodegraph_synthesize.make_samples import made_samples, write_sample

_NAMES = ("face", "actor_a", "actor_b", "actor_c")


@cache
def _made() -> dict[str, SyntheticFace]:
    return made_samples()


def test_the_samples_are_those_that_ship() -> None:
    assert tuple(_made()) == _NAMES
    shipped = sample_folder("face").parent
    assert {path.name for path in shipped.iterdir()} == set(_NAMES)


@pytest.mark.parametrize("name", _NAMES)
def test_a_sample_is_what_the_generator_makes(name: str) -> None:
    """To float32: another processor may round the last digits of a double otherwise."""
    made = _made()[name]
    shipped = read_c3d(sample_folder(name) / "recording.c3d")
    assert shipped.markers == made.captured.markers
    assert shipped.rate == made.captured.rate
    np.testing.assert_array_equal(shipped.present, made.captured.present)
    np.testing.assert_allclose(
        shipped.positions, made.captured.positions, rtol=0, atol=2e-5, equal_nan=True
    )


@pytest.mark.parametrize("name", _NAMES)
def test_a_samples_marker_set_and_model_are_the_generators(name: str) -> None:
    made = _made()[name]
    assert read_marker_set_yaml(sample_folder(name) / "markers.yaml") == made.marker_set
    model = np.load(sample_folder(name) / "model.npz")
    assert tuple(model["shape_names"].tolist()) == made.model.names
    assert tuple(model["markers"].tolist()) == made.model.markers
    np.testing.assert_allclose(model["neutral"], made.model.neutral, rtol=0, atol=1e-9)
    np.testing.assert_allclose(model["shapes"], made.model.shapes, rtol=0, atol=1e-9)


def test_the_face_is_damaged_and_the_actors_are_complete() -> None:
    face = _made()["face"]
    assert 0.04 < 1.0 - face.captured.present.mean() < 0.06
    assert face.impulses.hidden.any()
    for name in _NAMES[1:]:
        assert _made()[name].captured.present.all()
        assert not _made()[name].impulses.hidden.any()


def test_the_actors_are_three_faces() -> None:
    neutrals = [_made()[name].model.neutral for name in _NAMES]
    for index, one in enumerate(neutrals):
        for other in neutrals[index + 1 :]:
            assert np.abs(one - other).max() > 1.0


def test_writing_again_gives_the_same_bytes(tmp_path: Path) -> None:
    for folder in (tmp_path / "one", tmp_path / "two"):
        write_sample(folder, _made()["actor_a"])
    for path in (tmp_path / "one").iterdir():
        assert path.read_bytes() == (tmp_path / "two" / path.name).read_bytes()
