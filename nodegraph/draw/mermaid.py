"""Pictures as Mermaid flowcharts, which many sites and editors render."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping

from nodegraph.draw.boxes import clean
from nodegraph.draw.frames import frames_of, label_of, outline
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
    lines += _nested(picture, ids)
    lines += [
        f'  {ids[arrow.source]} {_line(arrow)}|"{_label(arrow)}"| {ids[arrow.target]}'
        for arrow in picture.arrows
    ]
    return "\n".join(lines) + "\n"


def _nested(picture: Picture, ids: Mapping[str, str]) -> Iterator[str]:
    boxes = {box.name: box for box in picture.boxes}
    frames = frames_of(boxes)
    opened = 0
    for kind, name, depth in outline(frames):
        indent = "  " * (depth + 1)
        if kind == "open":
            yield f'{indent}subgraph frame{opened}["{_text(name)}"]'
            opened += 1
        elif kind == "close":
            yield f"{indent}end"
        else:
            yield f"{indent}{ids[name]}{_box(boxes[name], label_of(name, frames[name]))}"


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
