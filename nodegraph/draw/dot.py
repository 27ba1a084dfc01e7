"""Pictures in the DOT language of Graphviz."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from nodegraph.draw.boxes import clean, escaped
from nodegraph.draw.frames import nested
from nodegraph.draw.picture import Arrow, Box, Picture, Socket


def dot(picture: Picture) -> str:
    """Return the picture in the DOT language.

    Boxes whose dotted names have a common prefix stand in a cluster. Every name is written
    as a quoted string or as escaped markup; identifiers are numbered.
    """
    numbers = {box.name: index for index, box in enumerate(picture.boxes)}
    boxes = {box.name: box for box in picture.boxes}
    lines = [
        "digraph {",
        f"  graph [label={_quoted(picture.title)}, labelloc=t, rankdir=LR, fontname=Helvetica];",
        "  node [shape=plain, fontname=Helvetica, fontsize=11];",
        "  edge [fontname=Helvetica, fontsize=9];",
    ]

    def box_line(name: str, label: str) -> str:
        return f"n{numbers[name]} [label=<{_table(boxes[name], label)}>];"

    lines += nested(boxes, _begin, "}", box_line)
    lines += [_edge(arrow, numbers, boxes) for arrow in picture.arrows]
    return "\n".join([*lines, "}\n"])


def _begin(number: int, name: str) -> list[str]:
    look = f"label={_quoted(name)}, labelloc=t, labeljust=l, style=rounded, color=gray60"
    return [f"subgraph cluster_{number} {{", f"  graph [{look}];"]


def _quoted(text: str) -> str:
    """Return a quoted string that shows the text as it is: Graphviz reads entities in it too."""
    plain = clean(text).replace("&", "&amp;").replace("\\", "\\\\").replace('"', '\\"')
    return f'"{plain}"'


def _markup(text: str) -> str:
    """Return text for a label of markup, where a backslash would begin an escape as well."""
    return escaped(text.replace("\\", "\\\\"))


def _table(box: Box, label: str) -> str:
    span = max(1, len(box.inputs)) * max(1, len(box.outputs))
    cell = f'<TR><TD COLSPAN="{span}">'
    rows = [f"{cell}<B>{_markup(label)}</B></TD></TR>"]
    lines = [*box.texts, " | ".join(map(str, box.alternatives)), ", ".join(map(str, box.axes))]
    rows += [f"{cell}{_markup(line)}</TD></TR>" for line in lines if clean(line)]
    inputs, outputs = _ports(box.inputs, "i", span), _ports(box.outputs, "o", span)
    border = 2 if box.kind == "report" else 1
    style = ' STYLE="ROUNDED"' if box.kind == "input" else ""
    attributes = f'BORDER="{border}" CELLBORDER="0" CELLSPACING="0" CELLPADDING="3"{style}'
    return f"<TABLE {attributes}>{inputs}{''.join(rows)}{outputs}</TABLE>"


def _ports(sockets: Sequence[Socket], side: str, span: int) -> str:
    cells = [
        f'<TD PORT="{side}{index}" COLSPAN="{span // len(sockets)}">{_markup(str(socket))}</TD>'
        for index, socket in enumerate(sockets)
    ]
    return f"<TR>{''.join(cells)}</TR>" if cells else ""


def _edge(arrow: Arrow, numbers: Mapping[str, int], boxes: Mapping[str, Box]) -> str:
    outputs = [socket.name for socket in boxes[arrow.source].outputs]
    inputs = [socket.name for socket in boxes[arrow.target].inputs]
    begin = f"n{numbers[arrow.source]}:o{outputs.index(arrow.source_port)}:s"
    end = f"n{numbers[arrow.target]}:i{inputs.index(arrow.target_port)}:n"
    styles = ["style=dashed"] * arrow.truth + ["penwidth=3"] * arrow.gathers
    styles += [f"label={_quoted(f'at {arrow.fixed}')}"] if arrow.fixed else []
    return f"  {begin} -> {end}" + (f" [{', '.join(styles)}]" if styles else "") + ";"
