"""The nodes that are installed: what they reach is theirs, and does not depend on the asking."""

from __future__ import annotations

import gc
import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nodegraph.fingerprint import Code, Reached
from nodegraph.fingerprint.step_keys import followed
from nodegraph.plugin.registry import default_registry

ROOT = Path(__file__).parents[3]
MACHINE = {
    f"nodegraph.{name}"
    for name in (
        "errors",
        "kernels",
        "node.declaration",
        "node.live_form",
        "node.ports",
        "node.values",
        "plugin.formats",
        "plugin.hook_types",
    )
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


def test_garbage_is_collected_again(functions: dict[str, Callable[..., object]]) -> None:
    Code([]).of(next(iter(functions.values())))
    assert gc.isenabled()


def test_every_node_is_stable(answers: dict[str, Reached]) -> None:
    assert answers
    assert not {name: answer.unstable for name, answer in answers.items() if answer.unstable}


def test_of_the_machine_only_what_a_plugin_uses_counts(answers: dict[str, Reached]) -> None:
    """An edit of the machine leaves results as they are, unless nodes call what was edited."""
    reached = {
        unit.partition(":")[0]
        for answer in answers.values()
        for unit in answer.units
        if unit.startswith(("nodegraph.", "nodegraph:"))
    }
    assert reached <= MACHINE


def test_every_version_of_what_is_installed_is_known(answers: dict[str, Reached]) -> None:
    versions = [item for answer in answers.values() for item in answer.versions.items()]
    assert versions
    assert not [name for name, version in versions if version == "unknown" and find_spec(name)]


def test_a_fill_reaches_its_kernel_and_no_other_fill(answers: dict[str, Reached]) -> None:
    reached = answers["fill:fill.muscle"]
    assert "nodegraph_fill.stepwise_kernel:_weigh_muscle" in reached.units
    assert "nodegraph_mocap.recording:Trajectories" in reached.units
    assert not [unit for unit in reached.units if unit.startswith("nodegraph_fill.guenter")]
    assert {"numpy", "numba", "python"} <= set(reached.versions)


def test_a_live_form_that_is_folded_counts(answers: dict[str, Reached]) -> None:
    reached = answers["gaps:gaps.dropout"]
    assert "nodegraph_gaps.dropout:_Stream" in reached.units


def test_where_machine_code_is_kept_does_not_count(answers: dict[str, Reached]) -> None:
    reached = answers["fill:fill.muscle"]
    units = {unit for unit in reached.units if ".kernels:" in unit}
    assert units == {"nodegraph.kernels:_Function", "nodegraph.kernels:kernel"}
    assert "platformdirs" not in reached.versions


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


def test_another_process_finds_the_same(answers: dict[str, Reached]) -> None:
    script = (
        "from nodegraph.fingerprint import Code\n"
        "from nodegraph.plugin.registry import default_registry\n"
        "registry = default_registry()\n"
        "names = {'nodegraph'} | {plugin.module.__name__ for plugin in registry.loaded}\n"
        "print(Code(names).of(registry.find('compare.table').node.function).digest)"
    )
    result = {
        subprocess.run(
            [sys.executable, "-c", script],
            capture_output=True,
            text=True,
            check=True,
            env={"PYTHONHASHSEED": seed, "PYTHONPATH": f"{ROOT}:{ROOT / 'plugins'}"},
        ).stdout.strip()
        for seed in ("1", "2")
    }
    assert result == {answers["compare:compare.table"].digest}
