"""Pictures as Mermaid flowcharts, which many sites and editors render."""

from __future__ import annotations

import json

from nodegraph.draw.boxes import clean
from nodegraph.draw.frames import nested
from nodegraph.draw.picture import Arrow, Box, Picture

_PLAIN = frozenset(" _.,:-=")
_SHAPES = {"node": ('["', '"]'), "input": ('(["', '"])'), "report": ('[["', '"]]')}


def mermaid(picture: Picture) -> str:
    """Return the picture as a Mermaid flowchart.

    Truth is dotted, gathering arrows are thick; boxes whose dotted names have a common prefix
    stand in a subgraph. Characters that are special to Mermaid are written as entities, so that
    no name can end its label.
    """
    ids = {box.name: f"n{index}" for index, box in enumerate(picture.boxes)}
    title = clean(picture.title).replace("<", "&lt;").replace(">", "&gt;")
    lines = ["---", f"title: {json.dumps(title, ensure_ascii=False)}", "---", "flowchart LR"]
    boxes = {box.name: box for box in picture.boxes}
    lines += nested(boxes, _begin, "end", lambda name, label: ids[name] + _box(boxes[name], label))
    lines += [
        f'  {ids[arrow.source]} {_line(arrow)}|"{_label(arrow)}"| {ids[arrow.target]}'
        for arrow in picture.arrows
    ]
    return "\n".join(lines) + "\n"


def _begin(number: int, name: str) -> list[str]:
    return [f'subgraph frame{number}["{_text(name)}"]']


def _text(text: str) -> str:
    return "".join(
        character if character.isalnum() or character in _PLAIN else f"#{ord(character)};"
        for character in clean(text)
    )


def _box(box: Box, label: str) -> str:
    begin, end = _SHAPES[box.kind]
    lines = [*box.texts, " | ".join(map(str, box.alternatives)), ", ".join(map(str, box.axes))]
    return begin + "<br/>".join(map(_text, [label, *filter(None, lines)])) + end


def _line(arrow: Arrow) -> str:
    if arrow.gathers:
        return "==>"
    return "-.->" if arrow.truth else "-->"


def _label(arrow: Arrow) -> str:
    label = _text(" to ".join(dict.fromkeys((arrow.source_port, arrow.target_port))))
    notes = ["truth"] * (arrow.truth and arrow.gathers) + [f"at {arrow.fixed}"] * bool(arrow.fixed)
    return "<br/>".join([label, *map(_text, notes)])
