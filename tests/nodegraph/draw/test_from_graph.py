"""A picture says which axes begin at a node, and with which labels."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from nodegraph.draw import Axis
from nodegraph.draw.from_graph import labels_text, picture_of
from nodegraph.graph import Graph
from nodegraph.node.decorator import node
from nodegraph.node.ports import Label


@pytest.mark.parametrize(
    ("labels", "text"),
    [
        ((5, 15, 45), "5, 15, 45"),
        (tuple(range(20)), "0 … 19 (20)"),
        (("a" * 40, "b"), f"{'a' * 31}…, b"),
        (
            ("clean", "low_passed", "white noise", "impulses"),
            "clean, low_passed, white noise, impulses",
        ),
        (("face_1", "face_2", "face_3", "face_4"), "face_1 … face_4 (4)"),
        (("a" * 40, *["b" * 30] * 5, "c"), f"{'a' * 31}… … c (7)"),
    ],
)
def test_many_labels_are_counted(labels: tuple[Label, ...], text: str) -> None:
    assert labels_text(labels) == text


def test_axes_and_alternatives_are_shown_where_they_begin(graph_of: Callable[..., Graph]) -> None:
    text = """
    axes: {length: [5, 15], trial: {count: 20}, once: [1]}
    nodes:
      capture: {use: read.number}
      gaps: {use: gaps.cut, in: capture, with: {length: $length, seed: $trial}}
      again: {use: gaps.cut, in: gaps.gappy, with: {length: $once, seed: $trial}}
      other: {use: gaps.cut, in: capture, with: {length: 1, seed: $trial}}
      fill:
        in: again.gappy
        with: {max_gap: 9}
        alternatives:
          hold: {use: fill.hold}
          line: {use: fill.scale}
          cube: {use: fill.scale, with: {power: 3}}
          scale: {use: fill.scale}
      error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
      table: {use: compare.table, in: error}
    report: [table]
    """
    boxes = {box.name: box for box in picture_of(graph_of(text)).boxes}
    assert [*map(str, boxes["gaps"].axes)] == ["length: 5, 15 frames", "trial: 0 … 19 (20)"]
    assert boxes["again"].axes == ()  # a wire brings trial, and an axis of one label is not said
    assert boxes["other"].axes == (Axis("trial"),)  # labels are said once
    assert boxes["fill"].axes == ()
    assert [*map(str, boxes["fill"].alternatives)] == [
        *("hold", "line fill.scale", "cube fill.scale, power: 3", "scale power: 2.0"),
    ]
    kinds = {name: box.kind for name, box in boxes.items()}
    assert kinds == {
        "capture": "input", "gaps": "node", "again": "node", "other": "node", "fill": "node",
        "error": "node", "table": "report",
    }  # fmt: skip
    types = {socket.name: socket.type for socket in boxes["gaps"].outputs}
    assert types == {"gappy": "float", "truth": "Truth[float]", "hidden": "int"}
    assert [socket.name for socket in boxes["again"].outputs] == ["gappy"]
    whole = {box.name: box for box in picture_of(graph_of(text), whole=True).boxes}
    assert [socket.name for socket in whole["again"].outputs] == ["gappy", "truth", "hidden"]
    assert boxes["fill"].lines == ("max_gap: 9",)
    assert [whole[name].lines for name in ("fill", "gaps", "again")] == [
        ("max_gap: 9",),
        ("gaps.cut",),
        ("gaps.cut", "length: 1"),
    ]


@pytest.mark.parametrize(
    ("summary", "does"),
    [
        ("Cut a part out (Zhang et al.).", "Cut a part out"),
        ("Read a recording: C3D, or CSV.", "Read a recording"),
        (
            "Error, lag and movement kept, a row per marker.",
            "Error, lag and movement kept, a row per marker",
        ),
        (
            "Error, lag and movement of a marker that is kept, a row per marker and take.",
            "Error, lag and movement of a marker that is kept",
        ),
        (f"Fill {'gaps ' * 20}well, fast.", f"Fill {'gaps ' * 20}well"),
    ],
)
def test_a_box_says_what_its_method_does(
    graph_of: Callable[..., Graph], summary: str, does: str
) -> None:
    def any_of(value: float) -> float:
        return value

    any_of.__doc__ = summary
    text = """
    nodes:
      capture: {use: read.number}
      some: {use: some.of, in: capture}
      both: {in: capture, alternatives: {same: some.of, again: some.of, pass: {}}}
      one: {in: capture, alternatives: {same: some.of, pass: {}}}
      several: {in: capture, alternatives: [some.of, fill.hold]}
    """
    boxes = {
        box.name: box for box in picture_of(graph_of(text, more=[node("some.of")(any_of)])).boxes
    }
    said = [boxes[name].does for name in ("some", "both", "one", "several")]
    assert said == [does, does, "", ""]
    assert [row.settings for row in boxes["one"].alternatives] == ["some.of", "unchanged"]


def test_a_gathering_port_says_what_it_gathers(graph_of: Callable[..., Graph]) -> None:
    text = """
    axes: {length: [5, 15], trial: {count: 20}}
    nodes:
      capture: {use: read.number}
      gaps: {use: gaps.cut, in: capture, with: {length: $length, seed: $trial}}
      fill: {in: gaps.gappy, alternatives: [fill.hold, fill.scale]}
      error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
      table: {use: compare.table, in: {scores: {from: error, at: {length: 5}}}}
      named:
        use: compare.table
        in:
          scores:
            held: {from: error, at: {fill: hold, length: 5}}
            scaled: {from: error, at: {fill: scale, length: 5}}
    report: [table, named]
    """
    picture = picture_of(graph_of(text))
    gathers = {box.name: box.inputs[0].gathers for box in picture.boxes if box.inputs}
    assert {*gathers["table"].split(" \N{MULTIPLICATION SIGN} ")} == {"20 trial", "2 fill"}
    assert gathers["named"] == "20 trial"
    rows = {box.name: [*map(str, box.alternatives)] for box in picture.boxes}
    assert rows["named"] == ["held from error", "scaled from error"]
    assert gathers["fill"] == ""
    fixed = {arrow.target: arrow.fixed for arrow in picture.arrows if arrow.gathers}
    assert fixed == {"table": "length=5", "named": "length=5"}


def test_an_output_without_a_name_of_its_own_shows_a_type_that_is_new(
    graph_of: Callable[..., Graph],
) -> None:
    text = """
    nodes:
      capture: {use: read.number}
      fill: {use: fill.hold, in: capture}
      after: {use: fill.hold, in: fill}
    """
    boxes = {box.name: box for box in picture_of(graph_of(text)).boxes}
    assert [socket.text for socket in boxes["capture"].outputs] == ["float"]
    assert [socket.text for socket in boxes["fill"].outputs] == [""]
    whole = {box.name: box for box in picture_of(graph_of(text), whole=True).boxes}
    assert [socket.text for socket in whole["fill"].outputs] == ["output"]


def test_the_settings_that_few_labels_stand_for_are_a_table(
    graph_of: Callable[..., Graph],
) -> None:
    labels = ", ".join(f"condition_{number}: {{power: {number // 2}}}" for number in range(12))
    text = f"""
    axes:
      damage: {{none: {{power: 9}}, usual: {{power: 3}}, heavy: {{power: 9}}, last: {{power: 4}}}}
      condition: {{{labels}}}
      k: [1, 2, 3]
    nodes:
      capture: {{use: read.number}}
      each: {{use: fill.scale, in: capture, with: {{power: $damage.power}}}}
      again: {{use: fill.scale, in: each, with: {{power: $damage.power}}}}
      many: {{use: fill.scale, in: capture, with: {{power: $condition.power}}}}
      plain: {{use: fill.scale, in: capture, with: {{power: $k}}}}
    """
    boxes = {box.name: box for box in picture_of(graph_of(text)).boxes}
    assert boxes["each"].lines == boxes["plain"].lines == ("fill.scale",)
    values = (("none", "9"), ("usual", "3"), ("heavy", "9"), ("last", "4"))
    assert boxes["each"].axes == (Axis("damage", "none, usual, heavy, last", ("power",), values),)
    others = (("usual", "3"), ("last", "4"), ("others", "9"))
    assert boxes["again"].axes == (Axis("damage", "", ("power",), others),)
    assert [*map(str, boxes["plain"].axes)] == ["k: 1, 2, 3"]
    assert boxes["many"].lines == ("fill.scale", "power: 0 / 1 / 2 / 3 / 4 / 5 by condition")


def test_what_is_compared_is_said_with_the_axes_that_are_seen_in_the_end(
    graph_of: Callable[..., Graph],
) -> None:
    text = """
    axes: {trial: {count: 20}, other: [1, 2], unseen: [1, 2]}
    nodes:
      capture: {use: read.number}
      scaled:
        in: capture
        alternatives:
          twice: {use: fill.scale, with: {power: $trial}}
          same: {use: pass}
      held: {use: fill.scale, in: capture, with: {power: $other}}
      aside: {use: fill.scale, in: capture, with: {power: $unseen}}
      first: {use: fill.hold, in: {from: aside, at: {unseen: 1}}}
    report:
      - {show: scaled, title: How far?}
      - {show: held}
      - {show: first}
    """
    picture = picture_of(graph_of(text))
    assert picture.combinations == "2 alternatives of scaled, for each trial (20); other (2)"
    titles = {box.name: box.title for box in picture.boxes if box.kind == "report"}
    assert titles == {"scaled": "How far?", "held": "", "first": ""}


def test_what_no_answer_is_made_from_is_not_counted_and_the_report_has_its_order(
    graph_of: Callable[..., Graph],
) -> None:
    text = """
    axes: {trial: {count: 20}}
    nodes:
      capture: {use: read.number}
      aside: {in: capture, alternatives: [fill.hold, fill.scale]}
      fill: {in: capture, with: {power: $trial}, alternatives: {a: fill.scale, b: fill.scale}}
      drawn: {use: fill.hold, in: aside}
      table: {use: fill.hold, in: fill}
    report:
      - {show: table, title: How far?}
      - {show: drawn}
    """
    fill = "2 alternatives of fill, for each trial (20)"
    picture = picture_of(graph_of(text))
    assert [box.name for box in picture.boxes][-2:] == ["table", "drawn"]
    assert picture.combinations == f"2 alternatives of aside; {fill}"
    answered = picture_of(graph_of(text.replace("far?", "far?, answer: Far.")))
    assert {box.name for box in answered.boxes if box.answers} == {"table"}
    assert answered.combinations == fill


def test_an_alternative_says_at_which_labels_it_is(graph_of: Callable[..., Graph]) -> None:
    text = """
    axes: {wait: {none: 1, few: 2, many: 2}}
    nodes:
      capture: {use: read.number}
      fill:
        in: capture
        alternatives:
          any: {use: fill.scale, with: {power: 5}}
          late: {use: fill.hold}
          last: {use: fill.scale, with: {power: $wait}}
          never: {use: fill.hold}
    skip:
      - {fill: [late], wait: [none, few]}
      - {fill: [last], wait: none}
      - {fill: never}
    """

    def settings(graph: Graph) -> list[str]:
        (fill,) = (box for box in picture_of(graph).boxes if box.name == "fill")
        return [each.settings for each in fill.alternatives]

    assert settings(graph_of(text)) == [
        "fill.scale, power: 5",
        "fill.hold, only at wait many",
        "fill.scale, power: 2, at wait few \N{EN DASH} many",
        "fill.hold",
    ]
    assert settings(graph_of(text, only={"wait": ("none",)}))[1] == "fill.hold"
