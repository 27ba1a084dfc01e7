"""Whether what is compared is synthetic, as the graph knows it."""

from __future__ import annotations

from pathlib import Path

import pytest

import nodegraph as ng
from nodegraph import Across
from nodegraph.plan import plan


@pytest.mark.parametrize(
    ("recordings", "synthetic"),
    [
        ("sample:face_1, sample:face_2", True),
        ("sample:face_1, mine.c3d", False),
        ("mine.c3d, yours.c3d", False),
    ],
)
def test_what_is_gathered_is_synthetic_where_every_source_is(
    tmp_path: Path, recordings: str, synthetic: bool
) -> None:
    for name in ("mine.c3d", "yours.c3d"):
        (tmp_path / name).touch()
    path = tmp_path / "graph.yaml"
    path.write_text(
        f"""
nodegraph: 1
axes: {{recording: [{recordings}]}}
nodes:
  capture: {{use: read.recording, with: {{path: $recording}}}}
  hide: {{use: gaps.cut, in: capture}}
  fill: {{in: hide.gappy, alternatives: {{linear: fill.linear}}}}
  error: {{use: score.gaps, in: {{estimate: fill, truth: hide.truth, hidden: hide.hidden}}}}
  table: {{use: compare.table, in: error}}
""",
        encoding="utf-8",
    )
    planned = plan(ng.load(path))
    fed = planned.steps[planned.cells["table"][()]].inputs["scores"]
    assert isinstance(fed, Across)
    assert fed.synthetic is synthetic
