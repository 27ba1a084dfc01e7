from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph.errors import Place, Problems
from nodegraph.graphfile.axes import read_axis
from nodegraph.graphfile.spec import AxisSpec
from nodegraph.graphfile.yaml_text import read_yaml


def read(text: str, folder: Path = Path()) -> tuple[AxisSpec, list[str]]:
    problems = Problems()
    axis = read_axis("k", read_yaml(text, "t.yaml"), folder, problems)
    return axis, [str(problem) for problem in problems.all()]


@pytest.mark.parametrize(
    ("text", "pairs"),
    [
        ("[5, 15]", {5: 5, 15: 15}),
        ("[low, 1.5, true]", {"low": "low", 1.5: 1.5, True: True}),
        ("{a: 5, b: [1, 2]}", {"a": 5, "b": [1, 2]}),
        (
            "{ME: {rec: me.c3d, k: 3}, 7: {rec: x}}",
            {"ME": {"rec": "me.c3d", "k": 3}, 7: {"rec": "x"}},
        ),
        ("{count: 3}", {0: 0, 1: 1, 2: 2}),
        ("{range: [5, 20, 5]}", {5: 5, 10: 10, 15: 15, 20: 20}),
        ("{range: [5, 19, 5]}", {5: 5, 10: 10, 15: 15}),
        ("{range: [3, 1, -1]}", {3: 3, 2: 2, 1: 1}),
        ("{range: [2, 2, 1]}", {2: 2}),
        ("{count: 3, other: 4}", {"count": 3, "other": 4}),
    ],
)
def test_every_form_of_an_axis(text: str, pairs: dict[object, object]) -> None:
    axis, problems = read(text)
    assert not problems
    assert dict(zip(axis.labels, axis.values, strict=True)) == pairs
    assert [type(label) for label in axis.labels] == [type(label) for label in pairs]


def test_a_label_per_file_that_matches(tmp_path: Path) -> None:
    for name in ("b.csv", "a.csv", "a.c3d", "deep/c.csv", ".hidden.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    axis, problems = read("{files: '*.csv'}", tmp_path)
    assert not problems
    assert (axis.labels, axis.values) == (("a", "b"), ("a.csv", "b.csv"))
    assert read("{files: '**/c.csv'}", tmp_path)[0].values == ("deep/c.csv",)
    for name in ("anna_b_1.csv", "ben_2.csv", "_3.csv"):
        (tmp_path / "deep" / name).touch()
    for start in ("deep/", "**/", "./de*/"):
        axis, _ = read(f"{{files: '{start}{{actor}}_{{take}}.csv'}}", tmp_path)
        assert dict(zip(axis.labels, axis.values, strict=True)) == {
            "anna_b_1": {"file": "deep/anna_b_1.csv", "actor": "anna_b", "take": "1"},
            "ben_2": {"file": "deep/ben_2.csv", "actor": "ben", "take": "2"},
        }
    for text, message in (
        ("{files: '{a}_{a}.csv'}", "t.yaml:1:9: files: {a} stands twice"),
        ("{files: '{file}.csv'}", "files: {file} cannot be a field"),
        ("{files: '{d}/{actor}.trc'}", "no file matches"),
        ("{files: '*.trc'}", "t.yaml:1:9: no file matches '*.trc'"),
        ("{files: 'a.*'}", "a.c3d and a.csv would have one label"),
        ("{files: [a]}", "files must be a pattern"),
    ):
        assert message in read(text, tmp_path)[1][0]


def test_a_range_of_fractions_reaches_its_last() -> None:
    axis, _ = read("{range: [0, 0.3, 0.1]}")
    assert axis.labels == pytest.approx((0, 0.1, 0.2, 0.3))


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ("[]", "1:1", "has no label"),
        ("{}", "1:1", "has no label"),
        ("5", "1:1", "an axis cannot be 5"),
        ("~", "1:1", "an axis cannot be None"),
        ("[1, [2]]", "1:5", "a label must be a word"),
        ("[1, {a: 2}]", "1:5", "a label must be a word"),
        ("[1, ~]", "1:5", "a label must be a word"),
        ("[1, .nan]", "1:5", "a label must be a word"),
        ("['', 1]", "1:2", "a label must be a word"),
        ("{a: 1, ~: 2}", "1:8", "None cannot be a label"),
        ("[5, 6, 5]", "1:8", "the label 5 twice"),
        ("[1, 1.0]", "1:5", "the label 1.0 twice"),
        ("{count: 0}", "1:9", "count must be a whole number"),
        ("{count: 2.0}", "1:9", "count must be a whole number"),
        ("{count: true}", "1:9", "count must be a whole number"),
        ("{count: 10000000}", "1:9", "count must be a whole number"),
        ("{range: 5}", "1:9", "range must be [first, last, step]"),
        ("{range: [1, 2]}", "1:9", "range must be [first, last, step]"),
        ("{range: [1, 2, 0]}", "1:9", "range must be [first, last, step]"),
        ("{range: [1, 2, -1]}", "1:9", "range must be [first, last, step]"),
        ("{range: [1, .inf, 1]}", "1:9", "range must be [first, last, step]"),
        ("{range: [1, a, 1]}", "1:9", "range must be [first, last, step]"),
        ("{range: [0, 10000000, 1]}", "1:9", "range has more than 1,000,000 labels"),
        ("{range: [0, 1, 1e-320]}", "1:9", "range has more than 1,000,000 labels"),
        ("{range: [-1e308, 1e308, 1]}", "1:9", "range has more than 1,000,000 labels"),
        (f"{{range: [0, 1{'0' * 400}, 1]}}", "1:9", "range has more than 1,000,000 labels"),
        (f"{{range: [0.5, 1{'0' * 400}, 0.5]}}", "1:9", "range has more than 1,000,000 labels"),
    ],
)
def test_a_wrong_axis_is_an_error_at_its_place(text: str, place: str, message: str) -> None:
    axis, problems = read(text)
    assert len(problems) == 1
    assert problems[0].startswith(f"t.yaml:{place}: ")
    assert message in problems[0]
    assert not axis.labels or "twice" in message


def test_an_axis_knows_where_it_was_written() -> None:
    assert read("[1]")[0].place == Place("t.yaml", 1, 1)
