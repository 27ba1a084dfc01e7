"""The nodes that are installed: what they reach is theirs, and does not depend on the asking."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from statistics import mean, median

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nodegraph.cache_key import Code, Reached, followed
from nodegraph.plugin.registry import default_registry

ROOT = Path(__file__).parents[3]
MACHINE = {
    "nodegraph.errors",
    "nodegraph.kernels",
    "nodegraph.live.forms",
    "nodegraph.live.running_numbers",
    "nodegraph.node",
    "nodegraph.node.declaration",
    "nodegraph.node.decorator",
    "nodegraph.node.live_form",
    "nodegraph.node.ports",
    "nodegraph.node.shared",
    "nodegraph.node.values",
    "nodegraph.plugin.formats",
    "nodegraph.plugin.hook_types",
    "nodegraph.plugin.streaming",
}


@pytest.fixture(scope="module")
def functions() -> dict[str, Callable[..., object]]:
    return {registered.full_name: registered.node.function for registered in default_registry()}


@pytest.fixture(scope="module")
def code() -> Code:
    return Code(followed(default_registry()))


@pytest.fixture(scope="module")
def answers(code: Code, functions: dict[str, Callable[..., object]]) -> dict[str, Reached]:
    return {name: code.of(function) for name, function in functions.items()}


@pytest.fixture(scope="module")
def remembered(code: Code, answers: dict[str, Reached]) -> dict[str, object]:
    return code.remembered()


def test_code_of_plugins_counts_by_its_content() -> None:
    assert followed(default_registry()) >= {"nodegraph", "nodegraph_fill", "nodegraph_tables"}


def test_every_node_is_stable(answers: dict[str, Reached]) -> None:
    assert answers
    assert not {name: answer.unstable for name, answer in answers.items() if answer.unstable}


def test_of_the_machine_only_what_a_plugin_uses_counts(answers: dict[str, Reached]) -> None:
    """An edit of the machine leaves results as they are, unless nodes call what was edited."""
    reached = {unit for answer in answers.values() for unit in answer.units}
    assert {unit for unit in reached if unit.partition(".")[0] == "nodegraph"} <= MACHINE


def test_an_edit_of_a_module_reaches_few_nodes(answers: dict[str, Reached]) -> None:
    nodes = Counter(unit for answer in answers.values() for unit in answer.units)
    plugins = [count for unit, count in nodes.items() if unit.startswith("nodegraph_")]
    assert median(plugins) == 1
    assert mean(plugins) < len(answers) / 15


def test_every_version_of_what_is_installed_is_known(answers: dict[str, Reached]) -> None:
    versions = [item for answer in answers.values() for item in answer.versions.items()]
    assert versions
    assert not [name for name, version in versions if version == "unknown" and find_spec(name)]


def test_a_fill_reaches_its_kernel_and_no_other_fill(answers: dict[str, Reached]) -> None:
    reached = answers["fill:fill.muscle"]
    assert {"nodegraph_fill.stepwise_kernel", "nodegraph_mocap.recording"} <= set(reached.units)
    assert "nodegraph_fill.guenter" not in reached.units
    assert {"numpy", "numba", "python"} <= set(reached.versions)


def test_a_node_that_reads_files_reaches_the_formats_of_the_plugins_in_use(
    functions: dict[str, Callable[..., object]], remembered: dict[str, object]
) -> None:
    registry = default_registry()
    every = {f"format:{form.name}" for form in registry.hooks.formats}

    def reached(names: set[str]) -> Reached:
        kept = [form for form in registry.hooks.formats if f"format:{form.name}" in names]
        code = Code(followed(registry), remembered, lambda: kept)
        return code.of(functions["files:read.recording"])

    assert {*every, "nodegraph_files.c3d"} <= set(reached(every).units)
    some = set(sorted(every)[1:])
    assert reached(some).digest != reached(every).digest
    assert set(reached(every).units) >= set(reached(some).units)


@settings(max_examples=10)
@given(data=st.data())
def test_the_order_of_asking_does_not_count(
    functions: dict[str, Callable[..., object]],
    answers: dict[str, Reached],
    remembered: dict[str, object],
    data: st.DataObject,
) -> None:
    code = Code(followed(default_registry()), remembered)
    for name in data.draw(st.permutations(sorted(functions))):
        assert code.of(functions[name]) == answers[name]


GRAPH = """
nodegraph: 1
axes: {recording: ["sample:face_1", "sample:face_2"]}
nodes:
  truth: {use: read.truth, with: {path: $recording}}
  take: {use: read.recording, with: {path: "sample:face_3"}}
  fill: {in: take, alternatives: [fill.linear, fill.cubic]}
  error: {use: score.distance, in: {estimate: fill, reference: truth}}
  table: {use: compare.table, in: error, with: {compare: fill}}
"""
SCRIPT = """
import nodegraph as ng
from nodegraph.cache_key import Code, followed
from nodegraph.plan import plan
from nodegraph.plugin.registry import default_registry

registry = default_registry()
print(Code(followed(registry)).of(registry.find("compare.table").node.function).digest)
step = plan(ng.load("study.yaml")).steps[-1]
print(step.name, *(source.files for source in step.inputs.values()))
"""


def test_processes_that_order_sets_in_other_ways_find_and_gather_the_same(
    answers: dict[str, Reached], tmp_path: Path
) -> None:
    (tmp_path / "study.yaml").write_text(GRAPH)
    printed = {
        subprocess.run(
            [sys.executable, "-c", SCRIPT],
            capture_output=True,
            text=True,
            check=True,
            cwd=tmp_path,
            env={"PYTHONHASHSEED": seed, "PYTHONPATH": f"{ROOT}:{ROOT / 'plugins'}"},
        ).stdout
        for seed in "12"
    }
    digest = answers["compare:compare.table"].digest
    assert printed == {f"{digest}\ntable ('face_1', 'face_2', 'face_3')\n"}
