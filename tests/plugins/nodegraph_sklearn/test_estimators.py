"""Estimators of scikit-learn as nodes: what they compute, and what they leave alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from sklearn.decomposition import PCA
from sklearn.impute import KNNImputer
from sklearn.linear_model import Ridge

import nodegraph
from nodegraph import NodegraphError, get_node
from nodegraph.testing import check_node
from nodegraph_mocap import Origin, Trajectories

FRAMES, MARKERS = 40, 5


@pytest.fixture(scope="module")
def complete() -> Trajectories:
    random = np.random.default_rng(0)
    shapes = random.normal(size=(2, MARKERS * 3))
    rows = np.cumsum(random.normal(size=(FRAMES, 2)), axis=0) @ shapes
    noise = 0.01 * random.normal(size=rows.shape)
    positions = (rows + noise).reshape(FRAMES, MARKERS, 3)
    return Trajectories(positions=positions, markers=tuple("abcde"), rate=60.0)


@pytest.fixture(scope="module")
def gappy(complete: Trajectories) -> Trajectories:
    positions = complete.positions.copy()
    positions[5:9, 0] = np.nan
    positions[20:22, 1:3] = np.nan
    return Trajectories(positions=positions, markers=complete.markers, rate=complete.rate)


def applied(name: str, recording: Trajectories, **settings: object) -> Trajectories:
    result = get_node(f"sklearn:{name}")(recording, **settings)
    assert isinstance(result, Trajectories)
    return result


def test_an_imputer_fills_what_scikit_learn_fills(gappy: Trajectories) -> None:
    filled = applied("sklearn.impute.KNNImputer", gappy, n_neighbors=3)
    rows = KNNImputer(n_neighbors=3).fit_transform(gappy.positions.reshape(FRAMES, -1))
    assert np.array_equal(filled.positions, rows.reshape(FRAMES, MARKERS, 3))
    assert np.array_equal(filled.origin == Origin.FILLED, ~gappy.present)


def test_a_regressor_learns_from_frames_in_which_the_others_are_present(
    gappy: Trajectories,
) -> None:
    filled = applied("sklearn.linear_model.Ridge", gappy, alpha=0.5)
    learnt = np.asarray(gappy.present.all(axis=1))
    learnt[5:9] = False
    others = gappy.positions[:, 1:].reshape(FRAMES, -1)
    fitted = Ridge(alpha=0.5).fit(others[learnt], gappy.positions[learnt, 0])
    assert np.allclose(filled.positions[5:9, 0], fitted.predict(others[5:9]), rtol=0, atol=1e-12)
    assert filled.present.all()


def test_a_transformer_keeps_what_its_inverse_gives_back(gappy: Trajectories) -> None:
    with pytest.warns(UserWarning, match="6 frames"):
        smooth = applied("sklearn.decomposition.PCA", gappy, n_components=2)
    whole = gappy.present.all(axis=1)
    rows = gappy.positions[whole].reshape(-1, MARKERS * 3)
    model = PCA(n_components=2, random_state=0)
    kept = model.inverse_transform(model.fit_transform(rows)).reshape(-1, MARKERS, 3)
    assert np.allclose(smooth.positions[whole], kept, rtol=0, atol=1e-9)
    assert np.array_equal(smooth.positions[~whole], gappy.positions[~whole], equal_nan=True)


def test_what_cannot_be_filled_stays_missing_and_is_counted(gappy: Trajectories) -> None:
    positions = gappy.positions.copy()
    positions[:, 4] = np.nan
    positions[30] = np.nan
    lost = Trajectories(positions=positions, markers=gappy.markers, rate=gappy.rate)
    with pytest.warns(UserWarning, match="40 samples of 1 markers"):
        applied("sklearn.impute.SimpleImputer", lost)
    with pytest.warns(UserWarning, match="44 samples of 5 markers"):
        applied("sklearn.linear_model.Ridge", lost)


@pytest.mark.parametrize(
    "name", ["sklearn.impute.KNNImputer", "sklearn.linear_model.Ridge", "sklearn.decomposition.PCA"]
)
def test_the_nodes_keep_the_promises_of_nodes(name: str) -> None:
    check_node(get_node(f"sklearn:{name}"))


@pytest.mark.parametrize(
    ("name", "named"),
    [
        ("sklearn.impute.KNNImputr", "KNNImputer"),
        ("sklearn.imputes.KNNImputer", "sklearn.imputes"),
        ("os.path", "sklearn"),
        ("KNNImputer", "sklearn.impute.KNNImputer"),
        ("sklearn.svm.SVC", "imputer"),
    ],
)
def test_a_name_of_no_use_is_an_error_that_says_why(name: str, named: str) -> None:
    with pytest.raises(NodegraphError, match=named):
        get_node(f"sklearn:{name}")


GRAPH = """\
nodegraph: 1
nodes:
  face: {use: synthesize.face, with: {seed: 1, seconds: 1.0}}
  gaps: {use: gaps.cut, in: face.truth, with: {length: 5, seed: 1}}
  fill:
    in: gaps.gappy
    alternatives:
      linear: {use: fill.linear}
      knn: {use: "sklearn:sklearn.impute.KNNImputer", with: {n_neighbors: 3}}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
"""


def test_an_estimator_stands_beside_other_methods_in_a_graph(tmp_path: Any) -> None:
    path = tmp_path / "knn.yaml"
    path.write_text(GRAPH)
    run = nodegraph.run(path, executor="processes", store=tmp_path / "store")
    assert run.ok
    assert set(run["error"].frame()["fill"]) == {"linear", "knn"}
