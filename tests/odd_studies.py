"""Graphs of comparisons of every odd shape, drawn from a seed, and the nodes that they use."""

from __future__ import annotations

import json
import random
from dataclasses import dataclass
from typing import Any

NODES = '''
import numpy as np
import pandas as pd
from nodegraph import Refusal, node
from nodegraph_mocap import Origin, Table, Trajectories
from nodegraph_tables import TableInfo, with_info


@node("odd.face", cite="none")
def face(*, actor: object = 0) -> Trajectories:
    """Make a face of three markers.

    Parameters
    ----------
    actor
        Whose.
    """
    place = np.arange(108.0).reshape(12, 3, 3) % 7 + len(str(actor))
    return Trajectories(positions=place, markers=("<b>lip", "chin", "नाक"), rate=60.0)


@node("odd.method", cite="none")
def method(recording: Trajectories, *, kind: str = "plain", shift: float = 1.0) -> Trajectories:
    """Move a face, or do not.

    Parameters
    ----------
    kind
        How it ends.
    shift
        By how much.
    """
    if kind == "refused":
        raise Refusal(TEXT)
    if kind == "fails":
        raise ValueError(TEXT)
    positions = recording.positions + shift
    if kind == "nothing":
        positions[:] = np.nan
    everywhere = np.ones(positions.shape[:2], dtype=bool)
    return recording.with_samples(positions, changed=everywhere, origin=Origin.REPAIRED)


@node("odd.score", cite="none")
def score(
    estimate: Trajectories, truth: Trajectories, *, a: object = 0, b: object = 0, c: object = 0,
    rows: int = 2, hole: bool = False, sign: float = 1.0, marked: bool = False, unit: str = "mm",
) -> Table:
    """Score a face, row by row.

    Parameters
    ----------
    a, b, c
        Of axes.
    rows
        So many.
    hole
        Whether the first row has no number.
    sign
        Of the numbers.
    marked
        Whether a row has a marker.
    unit
        Of the numbers.
    """
    off = float(np.mean(estimate.positions - truth.positions))
    random = np.random.default_rng(list(str((a, b, c)).encode()))
    values = sign * off * (1 + random.integers(0, 9, rows) / 8)
    if hole and rows:
        values[0] = np.nan
    made = {"gap": np.arange(rows), "rmse": values, "more": values**2}
    if marked:
        made = {"marker": [truth.markers[at % 3] for at in range(rows)], **made}
    return with_info(pd.DataFrame(made), TableInfo(title=TEXT, units={"rmse": unit}))
'''
TEXT = "</section><!-- <style>* { display: none }</style> <b onclick='window.ran = 1'>"
"""Of refusals, failures and titles; a report shows it as it is."""

NODES = NODES.replace("TEXT", repr(TEXT))

LABELS = (
    *("plain", "a b", "<b>x", "</section>", "<!--", "--><script>window.ran = 1</script>"),
    *("</style><style>* { display: none }</style>", "<plaintext>", "&amp;", "'", '"', "`x`"),
    *("a\u202eb", "नमस्ते", "العربية", "日本語", "\U0001f600", "$\\frac$", "%s", "{0}", "{{ x }}"),
    *("constructor", "__proto__", "toString", "null", "true", "0", "1e5", "-", "..", "a/b", "CON"),
    *("x" * 80, "eins, zwei", "a=b", "*", "~", "|", "\\", "_hidden", "é", "e\u0301", "-1.5"),
)
"""Of methods and of axes."""


@dataclass(frozen=True)
class Odd:
    """A graph as text, its axes with their labels, and its methods with how they end."""

    text: str
    axes: dict[str, int]
    methods: dict[str, str]


def odd_study(seed: int, most: int = 300) -> Odd:
    """Return the study of a seed, with so many steps of methods at most."""
    draw = random.Random(seed)
    axes: dict[str, dict[str, Any]] = {}
    room = most
    names = draw.sample(["trial", "share", "k", "length"], draw.choice((0, 1, 1, 2, 2, 3)))
    for name in names:
        count = min(draw.choice((1, 1, 2, 3, 5, 8, 24, 200)), max(1, room))
        room //= count
        kind = draw.choice(("count", "texts", "numbers"))
        if kind == "count":
            axes[name] = {"count": count}
        elif kind == "numbers" or count > len(LABELS):
            axes[name] = {str(at): at / 8 for at in range(count)}
        else:
            axes[name] = {label: at for at, label in enumerate(draw.sample(LABELS, count))}
    count = draw.randint(1, max(1, min(20, room)))
    kinds = draw.choice((("plain",), ("plain", "plain", "refused", "fails", "nothing"), ("tie",)))
    methods = {label: draw.choice(kinds) for label in draw.sample(LABELS, count)}
    if draw.random() < 0.05:
        methods = dict.fromkeys(methods, "refused")
    fills = {
        label: {
            "use": "odd.method",
            "with": {
                "kind": "plain" if kind == "tie" else kind,
                "shift": 1.0
                if kind == "tie"
                else draw.choice((0.0, 0.5, 1.0, 1e-9, 1e9, at + 1.0)),
            },
        }
        for at, (label, kind) in enumerate(methods.items())
    }
    source = names[0] if names and draw.random() < 0.4 else ""
    used = dict(zip("abc", (f"${name}" for name in names), strict=False))
    settings = {
        "rows": draw.choice((0, 1, 1, 2, 7)),
        "hole": draw.random() < 0.2,
        "sign": draw.choice((1.0, 1.0, 1.0, -1.0)),
        "marked": draw.random() < 0.5,
        "unit": draw.choice(("mm", "", "share", "mm^2", "<b>")),
    }
    within = draw.sample(names, draw.randint(0, len(names)))
    question: dict[str, Any] = {"metric": "rmse", "compare": "fill", "within": within}
    rest = [name for name in names if name not in within]
    if draw.random() < 0.5:
        question["blocks"] = [*draw.sample(rest, draw.randint(0, len(rest))), "gap"]
    clusters = [name for name in rest if name == source and _size(axes[name]) > 1]
    if clusters and draw.random() < 0.5:
        question["clusters"] = clusters
    optional = {
        "fallback": draw.choice([*methods]),
        "better": draw.choice(("lower", "higher", "none")),
    }
    question |= {name: value for name, value in optional.items() if draw.random() < 0.3}
    more = {"baseline": draw.choice([*methods]), "beside": ["more"], "columns": within[:1]}
    alone = {name: value for name, value in more.items() if draw.random() < 0.3}
    others = {
        "ranks": ("compare.ranks", question),
        "beliefs": ("compare.bayes", {k: v for k, v in question.items() if v != "none"}),
        "plain": ("compare.table", {}),
    }
    nodes: dict[str, Any] = {
        "x": {
            "use": "odd.face",
            "with": {"actor": f"${source}"} if source else {},
        },
        "fill": {"in": "x", "alternatives": fills},
        "error": {
            "use": "odd.score",
            "in": {"estimate": "fill", "truth": "x"},
            "with": {**used, **settings},
        },
        "table": {"use": "compare.table", "in": "error", "with": question | alone},
    }
    for name in draw.sample([*others], draw.choice((0, 0, 1))):
        nodes[name] = {"use": others[name][0], "in": "error", "with": others[name][1]}
    graph = {
        "nodegraph": 1,
        "title": draw.choice(("", TEXT, "A question?", *LABELS)) or "untitled",
        "notes": draw.choice(("why", TEXT, "```\nnever closed", "<!--", "| a |\n|---|\n| b |")),
        "axes": axes,
        "nodes": nodes,
        "report": [
            {"show": name, **{key: TEXT for key in ("caption", "notes") if draw.random() < 0.3}}
            for name in nodes
            if name in ("table", *others)
        ],
    }
    text = json.dumps(graph, ensure_ascii=False, indent=1)
    return Odd(text, {name: _size(axis) for name, axis in axes.items()}, methods)


def _size(axis: dict[str, Any]) -> int:
    return int(axis["count"]) if [*axis] == ["count"] else len(axis)
