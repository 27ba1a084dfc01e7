from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph import NodegraphError
from nodegraph.execute.results import Run

TEXT = """
axes: {k: [1, 2], one: [7]}
nodes:
  a: {use: read.number, with: {start: $k}}
  gaps: {use: gaps.cut, in: a, with: {length: $one}}
  fill: {in: gaps, alternatives: fill.*}
  table: {use: compare.table, in: fill}
skip: [{k: 2, fill: hold}]
report: [table]
"""


@pytest.fixture
def run(run_of: Callable[..., Run]) -> Run:
    return run_of(TEXT)


def test_a_value_is_found_by_its_labels(run: Run) -> None:
    assert run["a"].at(k=2) == 2
    assert run["fill"].at(k=1, one=7, fill="scale") == -12
    assert run["fill"].axes == ("k", "one", "fill")


def test_an_axis_with_one_label_may_be_left_out(run: Run) -> None:
    assert run["gaps"].at(k=2) == -5


def test_a_node_without_axes_has_one_value(run: Run) -> None:
    assert len(run["table"].value.scores) == 3


def test_an_output_is_found_by_its_name(run: Run) -> None:
    assert run["gaps.truth"].at(k=2) == 2
    assert run["gaps.hidden"].at(k=1) == 7
    assert run["gaps"].at(k=1) == run["gaps.gappy"].at(k=1)


def test_values_come_with_their_labels_in_order(run: Run) -> None:
    assert list(run["a"]) == [({"k": 1}, 1.0), ({"k": 2}, 2.0)]
    assert [at["fill"] for at, _ in run["fill"]] == ["hold", "scale", "scale"]


def test_values_that_were_released_are_computed_again(run: Run, calls: list[str]) -> None:
    assert run["fill"].at(k=1, fill="hold") == -5
    assert calls == ["read.number", "gaps.cut", "fill.hold"]
    calls.clear()
    assert run["table"].value
    assert calls == []


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda run: run["fil"], r"no node 'fil'; did you mean 'fill'"),
        (lambda run: run["gaps.trth"], r"'gaps' has no output 'trth'; did you mean 'truth'"),
        (lambda run: run["a"].at(kk=1), r"'a' has no axis 'kk'; did you mean 'k'"),
        (lambda run: run["a"].at(k=3), r"'k' has no label 3; there is: 1, 2"),
        (lambda run: run["fill"].at(fill="hld"), r"no label 'hld'; did you mean 'hold'"),
        (lambda run: run["a"].value, r"several values along 'k'; there is: 1, 2"),
        (lambda run: run["fill"].at(k=2, fill="hold"), r"skip: k = 2, fill = hold"),
    ],
)
def test_a_wrong_name_is_an_error_with_what_there_is(
    run: Run, ask: Callable[[Run], object], message: str
) -> None:
    with pytest.raises(NodegraphError, match=message):
        ask(run)


def test_a_node_that_is_left_out_has_a_reason(run_of: Callable[..., Run]) -> None:
    text = TEXT.replace("skip:", "  x: {use: fill.hold, in: {from: a, at: {k: 2}}}\nskip:").replace(
        "skip: [{k: 2, fill: hold}]", ""
    )
    run = run_of(text, only={"k": (1,)})
    with pytest.raises(NodegraphError, match=r"'x' is left out: the command has removed k=2"):
        _ = run["x"]


def test_a_value_that_cannot_be_computed_again_is_an_error(
    run_of: Callable[..., Run], tmp_path: Path
) -> None:
    path = tmp_path / "take.txt"
    path.write_text("1.5")
    run = run_of(
        """
        nodes:
          a: {use: read.file, with: {path: take.txt}}
          b: {use: fill.hold, in: a}
          c: {use: fill.hold, in: b}
        """
    )
    path.unlink()
    assert run["c"].value == 3.5
    with pytest.raises(NodegraphError, match=r"b cannot be computed again: a failed: .*take\.txt"):
        _ = run["b"].value


def test_the_text_of_a_run_is_one_line(run_of: Callable[..., Run]) -> None:
    run = run_of("axes: {k: [1, 2]}\nnodes: {a: {use: read.number, with: {start: $k}}}")
    assert repr(run) == "<Run of 'toy.yaml': 2 done>"
    assert repr(run["a"]) == "<Values of 'a': 2 along k>"
    assert (list(run), "a" in run, "b" in run) == (["a"], True, False)
