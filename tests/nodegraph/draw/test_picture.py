from __future__ import annotations

from dataclasses import replace

from nodegraph.draw import Alternative, Arrow, Axis, Box, Picture, Socket
from nodegraph.draw.picture import folded


def test_an_arrow_as_text() -> None:
    arrow = Arrow("a", "out", "b", "in", gathers=True, truth=True, fixed="k=3")
    assert str(arrow) == "a.out to b.in (at k=3, truth, gathers)"
    assert str(Arrow("a", "out", "b", "in")) == "a.out to b.in"


def test_boxes_that_only_show_are_one_list() -> None:
    out, scores = (Socket("out"),), (Socket("scores"),)
    boxes = (
        Box("face", outputs=(*out, Socket("truth")), kind="input"),
        Box("fill", inputs=(Socket("in"),), outputs=out),
        Box("chosen", ("select.pfa",), scores, out, kind="report"),
        Box("kept", inputs=(Socket("in"),), outputs=out),
        Box("curve", ("compare.curve", "x: k, compare: [a, b]"), scores, out, kind="report"),
        Box("figure", ("plot.selection",), (*scores, Socket("truth")), kind="report"),
        Box("faces", ("plot.faces",), (*scores, Socket("truth")), kind="report"),
        Box("glb", ("write.glb", "rate: 30"), scores, kind="report"),
    )
    arrows = (
        Arrow("face", "out", "fill", "in"),
        Arrow("fill", "out", "chosen", "scores"),
        Arrow("chosen", "out", "kept", "in"),
        Arrow("kept", "out", "curve", "scores"),
        Arrow("curve", "out", "figure", "scores"),
        Arrow("kept", "out", "figure", "scores", gathers=True, fixed="k=3"),
        Arrow("face", "truth", "figure", "truth", truth=True),
        Arrow("kept", "out", "faces", "scores"),
        Arrow("face", "truth", "faces", "truth", truth=True),
        Arrow("curve", "out", "glb", "scores"),
    )
    picture = folded(Picture("fold", boxes, arrows))
    assert [box.name for box in picture.boxes] == ["face", "fill", "chosen", "kept", "report"]
    report = picture.boxes[-1]
    dot = " \N{MIDDLE DOT} "
    assert report.lines == (f"glb{dot}write.glb",)  # it reads nothing outside the list
    items = (f"curve{dot}compare.curve", f"figure{dot}plot.selection", f"faces{dot}plot.faces")
    assert {socket.name: socket.items for socket in report.inputs} == {"curve": items}
    assert report.texts == (*report.lines, *items)
    assert picture.arrows[:3] == arrows[:3]  # a box that another one reads stays
    assert picture.arrows[3:] == (
        Arrow("kept", "out", "report", "curve", gathers=True),
        Arrow("face", "truth", "report", "curve", truth=True),
    )
    assert folded(picture) == picture


def test_outputs_that_only_the_list_reads_stand_below_the_others() -> None:
    port, outputs = (Socket("x"),), (Socket("error"), Socket("noise"), Socket("filled"))
    boxes = (
        Box("fill", outputs=outputs),
        Box("drawn", inputs=port),
        Box("table", inputs=port, kind="report"),
    )
    arrows = (
        Arrow("fill", "filled", "drawn", "x"),
        *(Arrow("fill", name, "table", "x") for name in ("error", "noise")),
    )
    fill, *_ = folded(Picture("", boxes, arrows)).boxes
    assert [socket.name for socket in fill.outputs] == ["filled", "error", "noise"]


def test_a_box_called_report_keeps_its_name() -> None:
    port = (Socket("x"),)
    boxes = (Box("report", outputs=port), *(Box(n, (), port, kind="report") for n in "ab"))
    arrows = tuple(Arrow("report", "x", name, "x") for name in "ab")
    assert [box.name for box in folded(Picture("", boxes, arrows)).boxes] == ["report", "report "]


def test_alternatives_of_several_boxes_are_listed_once() -> None:
    ways = (Alternative("stable"), Alternative("all", "landmarks: [*]"))
    boxes = (Box("align", alternatives=ways), Box("own", alternatives=ways), Box("fill"))
    align, own, fill = folded(Picture("", boxes)).boxes
    assert (align, fill) == (boxes[0], boxes[2])
    assert own.alternatives == (Alternative("the same 2 as align"),)


def test_what_several_boxes_do_is_said_once() -> None:
    boxes = tuple(Box(name, ("recording.crop",), does="Cut parts out of a take") for name in "abc")
    folds = folded(Picture("", boxes)).boxes
    assert [box.does for box in folds] == ["Cut parts out of a take", "", ""]
    assert {box.lines for box in folds} == {("recording.crop",)}


def test_the_inputs_of_a_graph_have_its_names_for_them() -> None:
    weights = (Socket("weights"),)
    boxes = (
        Box("complete", outputs=weights),
        Box("chosen", outputs=weights),
        Box("moved.all", inputs=weights, outputs=weights),
        Box("moved.chosen", inputs=weights, outputs=weights),
        Box(
            "moved",
            inputs=(Socket("all"),),
            outputs=(Socket("all"),),
            passes=True,
            names=(("complete.weights", "from_all"), ("chosen.weights", "from_chosen")),
        ),
        Box("table", inputs=(Socket("scores"),)),
    )
    arrows = (
        Arrow("complete", "weights", "moved.all", "weights"),
        Arrow("chosen", "weights", "moved.chosen", "weights"),
        Arrow("moved.all", "weights", "moved", "all"),
        Arrow("moved", "all", "table", "scores"),
        Arrow("moved.chosen", "weights", "table", "scores"),
    )
    *_, moved, table = folded(Picture("", boxes, arrows)).boxes
    assert table == boxes[-1]
    assert [socket.name for socket in moved.outputs] == ["all", "chosen"]
    assert [socket.text for socket in moved.inputs] == ["from_all", "from_chosen"]


def test_the_report_lists_titles_in_place_of_names_and_methods() -> None:
    port = (Socket("scores"),)
    boxes = (
        Box("score", outputs=port),
        Box("far", ("compare.table", "metric: rmse"), port, kind="report", title="How far?"),
        Box("near", ("compare.table", "metric: rmse"), port, kind="report"),
    )
    arrows = tuple(Arrow("score", "scores", name, "scores") for name in ("far", "near"))
    ((socket,),) = (box.inputs for box in folded(Picture("", boxes, arrows)).boxes[1:])
    dot = " \N{MIDDLE DOT} "
    assert socket.items == ("How far?", f"near{dot}compare.table")
    (card,) = folded(Picture("", boxes[:2], arrows[:1])).boxes[1:]
    assert card.inputs == (Socket("far", items=("How far?",)),)
    assert folded(Picture("", boxes[:1])) == Picture("", boxes[:1])


def test_linked_boxes_that_no_answer_is_made_from_are_one() -> None:
    port = (Socket("in"),)
    out = (Socket("output"),)
    boxes = (
        Box("take", outputs=(*out, Socket("truth"))),
        Box("fill", inputs=port, outputs=out),
        Box("still", inputs=port, outputs=out),
        Box("moved", ("animate.mesh",), port, out),
        Box("alone", inputs=port, outputs=out),
        Box("table", (), port, kind="report", title="How far?", answers=True),
        Box("faces", (), port, kind="report", title="Faces"),
        Box("other", (), port, kind="report", title="Another"),
    )
    ways = [("take", "fill"), ("fill", "table"), ("fill", "still"), ("still", "moved")]
    ways += [("still", "faces"), ("moved", "faces"), ("fill", "alone"), ("alone", "other")]
    arrows = tuple(Arrow(source, "output", target, "in") for source, target in ways)
    picture = folded(Picture("", boxes, arrows))
    by_name = {box.name: box for box in picture.boxes}
    assert [*by_name] == ["take", "fill", "moved", "alone", "report"]
    moved = by_name["moved"]
    assert (moved.lines, moved.does) == ((), "The last of 2 steps, after still")
    assert [socket.name for socket in by_name["moved"].outputs] == ["still", "output"]
    assert [str(arrow) for arrow in picture.arrows if arrow.target == "report"] == [
        *("fill.output to report.table", "moved.still to report.faces"),
        *("moved.output to report.faces", "alone.output to report.other"),
    ]
    unanswered = tuple(replace(box, answers=False) for box in boxes)
    assert "still" in {box.name for box in folded(Picture("", unanswered, arrows)).boxes}


def test_a_box_that_makes_one_alternative_is_its_row() -> None:
    port, out = (Socket("in"),), (Socket("out"),)
    axis = Axis("k", "5, 10")
    rows = (
        Alternative("random"),
        Alternative("pfa", "unchanged", "pfa"),
        Alternative("far", "power: 2", "other"),
        Alternative("near", "power: 3", "near"),
    )
    boxes = (
        Box("take", outputs=out, kind="input"),
        Box("pfa", ("select.pfa", "runs: 300"), port, out, axes=(axis,)),
        Box("other", ("read.take",), (), out, kind="input"),
        Box("near", ("read.near",), port, out),
        Box("chosen", (), (*port, Socket("like")), out, rows, compares=True),
        Box("table", (), port, kind="report"),
    )
    ways = [("take", "pfa", "in"), ("take", "chosen", "in"), ("pfa", "chosen", "in")]
    ways += [("pfa", "chosen", "like"), ("other", "chosen", "in"), ("near", "chosen", "in")]
    ways += [("take", "near", "in"), ("chosen", "table", "in")]
    arrows = tuple(Arrow(source, "out", target, name) for source, target, name in ways)
    by_name = {box.name: box for box in folded(Picture("", boxes, arrows)).boxes}
    assert by_name.keys() == {"take", "near", "chosen", "report"}
    chosen = by_name["chosen"]
    assert chosen.alternatives == (
        rows[0],
        Alternative("pfa", "select.pfa, runs: 300"),
        Alternative("far", "read.take, power: 2"),
        rows[3],
    )
    assert (chosen.axes, chosen.compares, chosen.kind) == ((axis,), True, "node")
    assert [socket.text for socket in chosen.inputs] == ["in", "in"]


def test_the_only_alternative_that_reads_need_not_say_from_where() -> None:
    out = (Socket("out"),)
    boxes = (
        Box("face", outputs=out, kind="input"),
        Box("other", ("read.take",), (), out, kind="input"),
        Box("error", inputs=(Socket("in"),)),
        Box(
            *("take", (), (Socket("in"),), out),
            (Alternative("own", "unchanged", "face"), Alternative("other", source="other")),
        ),
    )
    ways = (("face", "take"), ("other", "take"), ("face", "error"))
    arrows = tuple(Arrow(source, "out", target, "in") for source, target in ways)
    by_name = {box.name: box for box in folded(Picture("", boxes, arrows)).boxes}
    assert [str(row) for row in by_name["take"].alternatives] == [
        "own unchanged",
        "other read.take",
    ]
