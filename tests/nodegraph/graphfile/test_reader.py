from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph import GraphError, Placeholder
from nodegraph.errors import Place
from nodegraph.graphfile import GraphSpec, read_graph_file, read_graph_text
from nodegraph.graphfile.spec import Gathering, Reference, Variable

GOOD = """\
nodegraph: 1
title: A title
notes: |
  Some *notes*.
inputs: {recording: a.c3d, factor: 1.5}
axes:
  trial: {count: 2}
  actor: {ME: {rec: me.c3d}, MB: {rec: mb.c3d}}
nodes:
  capture: {use: read.file, with: {path: $recording, pair: [$trial, {deep: $actor.rec}]}}
  fill:
    in: {first: capture.gappy, stages: {before: capture, after: {from: fill.x, at: {trial: 0}}}}
    over: [trial]
    alternatives: {fill.*: {}, strong: {use: fill.scale, with: {power: 3}}, short: fill.x, pass: {}}
skip: [{trial: 0, fill: [strong, pass]}]
known: [capture, capture.gappy]
requires: [numpy>=1.0]
outputs: {filled: fill}
report: [fill]
"""


def read(text: str) -> GraphSpec:
    return read_graph_text(text, "t.yaml", Path())


def mistakes(text: str) -> list[str]:
    try:
        return [str(problem) for problem in read(text).problems]
    except GraphError as error:
        return [str(problem) for problem in error.problems]


def test_everything_that_a_file_says_is_read() -> None:
    spec = read(GOOD)
    assert not spec.problems
    assert (spec.title, spec.notes) == ("A title", "Some *notes*.\n")
    assert {name: each.value for name, each in spec.inputs.items()} == {
        "recording": "a.c3d",
        "factor": 1.5,
    }
    assert spec.axes["actor"].labels == ("ME", "MB")
    assert [str(reference) for reference in spec.known] == ["capture", "capture.gappy"]
    assert spec.requires == (("numpy>=1.0", Place("t.yaml", 17, 12)),)
    assert spec.skip[0].labels == {"trial": (0,), "fill": ("strong", "pass")}
    assert str(spec.outputs["filled"]) == str(spec.report[0]) == "fill"


def test_an_answer_is_words_with_places_for_a_verdict() -> None:
    text = "A: {best}, {behind lin ear at ends=met, length=5}, {tied at all}."
    (entry,) = read(GOOD.replace("[fill]", f"[{{show: fill, answer: '{text}'}}]")).report
    assert entry.answer == (
        "A: ",
        Placeholder("best", "", {}, "{best}"),
        ", ",
        Placeholder(
            "behind", "lin ear", {"ends": "met", "length": "5"},
            "{behind lin ear at ends=met, length=5}",
        ),
        ", ",
        Placeholder("tied", "", None, "{tied at all}"),
        ".",
    )  # fmt: skip
    assert entry.answer_place == Place("t.yaml", 19, 31)


def test_a_variable_stands_wherever_it_is_a_whole_value() -> None:
    written = read(GOOD).nodes["capture"].settings
    path = written["path"].value
    assert (path.name, path.field, path.place) == ("recording", "", Place("t.yaml", 10, 42))
    assert [str(variable) for variable in written["pair"].variables()] == ["$actor.rec", "$trial"]
    text = GOOD.replace("$recording", "a$recording")
    assert not isinstance(read(text).nodes["capture"].settings["path"].value, Variable)


def test_a_reference_has_every_form() -> None:
    fed = read(GOOD).nodes["fill"].wiring
    assert fed["first"] == Reference("capture", "gappy", Place("t.yaml", 12, 17))
    stages = fed["stages"]
    assert isinstance(stages, Gathering)
    assert stages.sources["after"].at == {"trial": 0}


def test_alternatives_have_every_form() -> None:
    node = read(GOOD).nodes["fill"]
    assert [(method.label, method.use) for method in node.methods] == [
        ("", "fill.*"),
        ("strong", "fill.scale"),
        ("short", "fill.x"),
        ("pass", "pass"),
    ]
    listed = read("nodegraph: 1\nnodes: {a: {alternatives: [x.a, p:x.b, pass]}}").nodes["a"]
    assert [method.label for method in listed.methods] == ["a", "p:b", "pass"]
    family = read("nodegraph: 1\nnodes: {a: {alternatives: x.*}}").nodes["a"]
    assert [method.use for method in family.methods] == ["x.*"]


@pytest.mark.parametrize(
    ("old", "new", "place", "message"),
    [
        ("nodegraph: 1", "nodegraph: 2", "1:12", "reads format 1, not 2"),
        ("nodegraph: 1\n", "", "1:1", "the format's number is missing"),
        ("title: A title", "title: [a]", "2:8", "'title' must be text"),
        ("title: A title", "titel: A title", "2:1", "unknown key 'titel'"),
        ("inputs: {recording: a.c3d, factor: 1.5}", "inputs: [a]", "5:9", "must be a mapping"),
        ("factor: 1.5", "2x: 1.5", "5:28", "'2x' cannot be a name"),
        ("factor: 1.5", "trial: 1.5", "7:3", "'trial' is a name in 'axes' and in 'inputs'"),
        ("factor: 1.5", "fill: 1.5", "11:3", "'fill' is a name in 'nodes' and in 'inputs'"),
        ("{count: 2}", "{count: -2}", "7:18", "count must be a whole number"),
        ("use: read.file", "use: [read.file]", "10:18", "'use' names a node"),
        ("use: read.file", "sue: read.file", "10:13", "unknown key 'sue'"),
        ("{path: $recording, pair: [$trial, {deep: $actor.rec}]}", "x", "10:35", "'with' is a map"),
        ("capture.gappy,", "capture.gappy.x,", "12:17", "'capture.gappy.x' is not a reference"),
        ("capture.gappy,", "5,", "12:17", "5 is not a reference"),
        ("at: {trial: 0}", "at: {trial: [0]}", "12:84", "'at' is {axis: label}"),
        ("at: {trial: 0}", "att: {trial: 0}", "12:80", "unknown key 'att'"),
        ("over: [trial]", "over: trial", "13:11", "'over' is a list"),
        ("fill.*: {}", "fill.*: {use: x.y}", "14:29", "unknown key 'use'"),
        ("use: fill.scale, with", "with", "14:40", "alternative 'strong' has no 'use'"),
        ("use: fill.scale", "use: 5", "14:46", "'use' names a node"),
        ("short: fill.x", "short: [fill.x]", "14:84", "'short' must be a mapping"),
        ("skip: [{trial: 0, fill: [strong, pass]}]", "skip: {trial: 0}", "15:7", "must be a list"),
        ("{trial: 0, fill: [strong, pass]}", "trial", "15:8", "an item of 'skip'"),
        ("known: [capture, ", "known: [capture.a.b, ", "16:9", "is not a reference"),
        ("report: [fill]", "report: fill", "19:9", "'report' must be a list"),
        ("[fill]", "[{show: fill, titel: x}]", "19:23", "unknown key 'titel'"),
        ("[fill]", "[{show: fill, title: [x]}]", "19:30", "'title' must be text"),
        ("[fill]", "[{show: fill, answer: '{bset}'}]", "19:31", "an unknown '{bset}'"),
        ("[fill]", "[{show: fill, answer: '{best at 5}'}]", "19:31", "an unknown '{best at 5}'"),
        ("[fill]", "[{show: fill, answer: 'a { b'}]", "19:31", "a brace without its other"),
        ("[fill]", "[{show: fill, answer: [x]}]", "19:31", "'answer' must be text"),
        ("[fill]", "[{show: {from: fill}}]", "19:17", "'show' is a node or one of its ports"),
        ("[fill]", "[{show: fill, at: 3}]", "19:27", "'at' is {axis: label}"),
        ("[fill]", "[{title: x}]", "19:10", "an entry of 'report' needs 'show'"),
        ("    alternatives: {", "    use: x.y\n    alternatives: {", "12:5", "has both 'use' and"),
    ],
)
def test_a_wrong_value_is_an_error_at_its_place(
    old: str, new: str, place: str, message: str
) -> None:
    assert old in GOOD
    errors = [error for error in mistakes(GOOD.replace(old, new)) if message in error]
    assert [error.partition(": ")[0] for error in errors] == [f"t.yaml:{place}"]


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ("", "1:1", "a graph file is a mapping"),
        ("- a\n", "1:1", "a graph file is a mapping"),
        ("just words", "1:1", "a graph file is a mapping"),
        ("nodegraph: 1", "1:1", "no 'nodes'"),
        ("nodegraph: 1\nnodes:", "2:1", "no 'nodes'"),
        ("nodegraph: 1\nnodes: {}", "2:1", "no 'nodes'"),
        ("nodegraph: 1\nnodes: {a: ~}", "2:12", "node 'a' must be a mapping"),
        ("nodegraph: 1\nnodes: {a: x.a}", "2:12", "write {use: x.a}"),
        ("nodegraph: 1\nnodes: {a: {use: [x.a]}}", "2:18", "write alternatives: [...]"),
        ("nodegraph: 1\nnodes: {a: {use: x.a, k: 1}}", "2:23", "settings stand under 'with'"),
        ("nodegraph: 1\nnodes: {a: {}}", "2:12", "needs 'use' or 'alternatives'"),
        ("nodegraph: 1\nnodes: {a: {use:x.a}}", "2:13", "unknown key 'use:x.a'"),
        ("nodegraph: 1\nnodes: {a: {alternatives: {b: {use:x.a}}}}", "2:32", "unknown key"),
        ("nodegraph: 1\nnodes: {a: {alternatives: {}}}", "2:27", "has no alternative"),
        ("nodegraph: 1\nnodes: {a: {alternatives: []}}", "2:27", "has no alternative"),
        ("nodegraph: 1\nnodes: {a: {alternatives: x.a}}", "2:27", "has no alternative"),
        ("nodegraph: 1\nnodes: {a: {alternatives: 5}}", "2:27", "has no alternative"),
        ("nodegraph: 1\nnodes: {a: {alternatives: [x.a, y.a]}}", "2:33", "'a' is used twice"),
        ("nodegraph: 1\nnodes: {a: {alternatives: [x.a, [y]]}}", "2:33", "is a node's name"),
        ("nodegraph: 1\nnodes: {a: {use: x.*}}", "2:18", "'x.*' stands only among alternatives"),
        (
            "nodegraph: 1\nnodes: {a: {use: x.y, in: {p: {1: b, '1': c}}}}",
            "2:38",
            "label '1' is used twice",
        ),
        ("nodegraph: 1\nnodes: {a: {use: x.y, in: {p: {}}}}", "2:31", "needs 'from'"),
        ("nodegraph: 1\nnodes: {a: {use: x.y, in: [b]}}", "2:27", "is not a reference"),
        ("nodegraph: 1\nnodes: {a: {use: x.y, in: {from: {a: b}}}}", "2:34", "another 'from'"),
    ],
)
def test_a_small_file_has_one_error(text: str, place: str, message: str) -> None:
    errors = mistakes(text)
    assert len(errors) == 1, errors
    assert errors[0].startswith(f"t.yaml:{place}: ")
    assert message in errors[0]


def test_a_missing_file_names_one_that_is_there(tmp_path: Path) -> None:
    (tmp_path / "fill.yaml").write_text(GOOD)
    with pytest.raises(GraphError, match=r"fil\.yaml: no such graph file\n.*did you mean 'fill"):
        read_graph_file(tmp_path / "fil.yaml")
    once = r"fill: no such graph file\n +did you mean 'fill\.yaml'\? in that folder there is: fill"
    with pytest.raises(GraphError, match=once):
        read_graph_file(tmp_path / "fill")
    with pytest.raises(GraphError, match="no such graph file"):
        read_graph_file(tmp_path / "nowhere" / "fill.yaml")


@pytest.mark.parametrize(
    ("content", "place"),
    [
        (b"\x89PNG\r\n\x1a\n\0\0", "1:1: not text in UTF-8: byte 0x89"),
        ("title: é\na: ".encode() + b"\xe9\n", "2:4: not text in UTF-8: byte 0xe9"),
        ("title: é".encode() + b"\xe9\n", "1:9: not text in UTF-8: byte 0xe9"),
    ],
)
def test_a_file_that_is_no_text_is_refused_at_its_byte(
    tmp_path: Path, content: bytes, place: str
) -> None:
    path = tmp_path / "binary.yaml"
    path.write_bytes(content)
    with pytest.raises(GraphError, match=rf"binary\.yaml:{place}"):
        read_graph_file(path)


def test_a_folder_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(GraphError, match=r"is a folder\n.*there is none"):
        read_graph_file(tmp_path)
    (tmp_path / "fill.yaml").write_text(GOOD)
    with pytest.raises(GraphError, match=r"is a folder\n.*name the graph file in it: fill\.yaml"):
        read_graph_file(tmp_path)


def test_a_byte_order_mark_is_no_error(tmp_path: Path) -> None:
    path = tmp_path / "bom.yaml"
    path.write_text(GOOD, encoding="utf-8-sig")
    assert not read_graph_file(path).problems


@given(
    st.lists(
        st.tuples(st.floats(0, 1, exclude_max=True), st.integers(1, 255), st.integers(0, 3)),
        min_size=1,
        max_size=4,
    )
)
def test_a_damaged_file_is_read_or_refused_and_nothing_else(
    damage: list[tuple[float, int, int]],
) -> None:
    data = bytearray(GOOD.encode())
    for share, byte, kind in damage:
        at = int(share * len(data))
        if kind == 0:
            data[at] ^= byte
        elif kind == 1:
            del data[at : at + byte]
        elif kind == 2:
            data[at:at] = bytes([byte])
        else:
            lines = data.splitlines(keepends=True)
            del lines[int(share * len(lines))]
            data = bytearray(b"".join(lines))
        data = data or bytearray(b" ")
    for error in mistakes(bytes(data).decode("utf-8", "replace")):
        assert error.startswith("t.yaml:")
