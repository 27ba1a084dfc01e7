"""Estimators of scikit-learn as nodes: what they compute, and what they leave alone."""

from __future__ import annotations

import re
from pathlib import Path
from textwrap import indent

import numpy as np
import pytest
from sklearn.decomposition import PCA
from sklearn.impute import KNNImputer
from sklearn.linear_model import Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVR

import nodegraph
from nodegraph import NodegraphError, get_node
from nodegraph.execute.call import Call
from nodegraph.execute.messages import CallCodec, respond
from nodegraph.execute.outcome import Outcome
from nodegraph.plugin.registry import Registry
from nodegraph.store import Packer
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


def test_a_regressor_of_one_output_is_fitted_to_each_coordinate(gappy: Trajectories) -> None:
    filled = applied("sklearn.svm.SVR", gappy, C=10.0)
    learnt = np.asarray(gappy.present.all(axis=1))
    others = gappy.positions[:, 1:].reshape(FRAMES, -1)
    for axis in range(3):
        fitted = SVR(C=10.0).fit(others[learnt], gappy.positions[learnt, 0, axis])
        assert np.allclose(filled.positions[5:9, 0, axis], fitted.predict(others[5:9]))


def test_a_pipeline_does_what_its_last_step_does(gappy: Trajectories) -> None:
    scaler, ridge = "sklearn.preprocessing.StandardScaler", "sklearn.linear_model.Ridge"
    steps = [scaler, {ridge: {"alpha": 0.5}}]
    filled = applied("sklearn.pipeline.Pipeline", gappy, steps=steps)
    learnt = np.asarray(gappy.present.all(axis=1))
    others = gappy.positions[:, 1:].reshape(FRAMES, -1)
    pipeline = make_pipeline(StandardScaler(), Ridge(alpha=0.5))
    fitted = pipeline.fit(others[learnt], gappy.positions[learnt, 0])
    assert np.allclose(filled.positions[5:9, 0], fitted.predict(others[5:9]), rtol=0, atol=1e-12)
    pca = {"sklearn.decomposition.PCA": {"n_components": 2}}
    with pytest.warns(UserWarning, match="6 frames"):
        smooth = applied("sklearn.pipeline.Pipeline", gappy, steps=[scaler, pca])
    assert np.array_equal(smooth.present, gappy.present)
    assert not np.allclose(smooth.positions[learnt], gappy.positions[learnt])


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
  gaps: {use: gaps.cut, in: face.truth, with: {length: 5, count: 3, seed: 1}}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
"""


def test_the_rivals_of_the_page_stand_beside_each_other_in_a_graph(tmp_path: Path) -> None:
    pages = Path(nodegraph.__file__).parent / "site" / "pages"
    text = (pages / "language.md").read_text(encoding="utf-8")
    fill = text.split("Five rivals for a fill:\n\n```yaml\n")[1].split("```")[0]
    path = tmp_path / "rivals.yaml"
    path.write_text(GRAPH + indent(fill, "  "), encoding="utf-8")
    run = nodegraph.run(path, jobs=1, store=tmp_path / "store")
    assert run.ok
    errors = run["error"].frame()
    assert errors["rmse"].notna().all()
    assert len(set(errors["fill"])) == 5


@pytest.mark.parametrize(
    ("name", "settings", "message"),
    [
        ("impute.KNNImputer", "n_neighbors: 0", "'n_neighbors' parameter of KNNImputer must be"),
        ("svm.SVR", "C: -1", "'C' parameter of SVR must be"),
        ("pipeline.Pipeline", "steps: [sklearn.svm.SVC]", "the last step is no regressor"),
        ("pipeline.Pipeline", "steps: [sklearn.svm.SVX]", "sklearn.svm has no class 'SVX'"),
        ("pipeline.Pipeline", "steps: 3", "'steps' parameter of Pipeline must be"),
        (
            "pipeline.Pipeline",
            "steps: [{sklearn.linear_model.Ridge: {alpha: -1}}]",
            "'alpha' parameter of Ridge must be",
        ),
        (
            "pipeline.Pipeline",
            "steps: [{sklearn.linear_model.Ridge: {alphas: 1}}]",
            "Ridge has no parameter 'alphas'; did you mean 'alpha'",
        ),
    ],
)
def test_settings_are_checked_before_the_run(
    tmp_path: Path, name: str, settings: str, message: str
) -> None:
    path = tmp_path / "wrong.yaml"
    fill = f'  fill: {{use: "sklearn:sklearn.{name}", in: gaps.gappy, with: {{{settings}}}}}\n'
    path.write_text(GRAPH + fill, encoding="utf-8")
    with pytest.raises(NodegraphError, match=re.escape(message)) as caught:
        nodegraph.load(path)
    assert "wrong.yaml:6:" in str(caught.value)


def test_an_estimator_is_a_node_in_another_process(gappy: Trajectories) -> None:
    registry = Registry.installed()
    entry = registry.find("sklearn:sklearn.impute.KNNImputer")
    packer = Packer(registry.hooks.kinds)
    codec = CallCodec(registry, packer, local=True)
    request = codec.encode(Call(0, entry.node, entry.plugin, {"recording": gappy}, {}))
    assert request is not None
    outcome = codec.decode(respond(request), "a process")
    assert isinstance(outcome, Outcome)
    assert isinstance(outcome.values[0], Trajectories)
    filled = applied("sklearn.impute.KNNImputer", gappy)
    np.testing.assert_array_equal(outcome.values[0].positions, filled.positions)
