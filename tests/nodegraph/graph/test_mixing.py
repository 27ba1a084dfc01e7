"""Methods that look ahead before samples are hidden are named, and others are not."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import pytest

from nodegraph import Truth, node
from nodegraph.execute.results import Run
from nodegraph.graph import Graph
from nodegraph.runs.record import record


class Noisy(NamedTuple):
    noisy: float
    truth: Truth[float]


@node("noise.add")
def noise(recording: float) -> Noisy:
    return Noisy(recording, recording)


@node("smooth.window", lookahead=lambda settings: settings["reach"])
def window(recording: float, *, reach: int = 2) -> float:
    return recording


@node("smooth.whole", lookahead=None)
def whole(recording: float) -> float:
    return recording


@node("smooth.causal", lookahead=0)
def causal(recording: float) -> float:
    return recording


@node("text.of", lookahead=None)
def text_of(recording: float) -> str:
    return str(recording)


MORE = (noise, window, whole, causal, text_of)
TEXT = """
axes: {{k: [0, 3]}}
nodes:
  capture: {{use: read.number}}
  smooth: {{in: capture, alternatives: {{a: {smooth}}}}}
  kept: {{use: fill.hold, in: smooth}}
  damage: {{use: {damage}, in: kept}}
  after: {{use: smooth.whole, in: damage}}
  error: {{use: score.gaps, in: {{estimate: after, truth: damage.truth, hidden: words}}}}
  words: {{use: text.count}}
"""


@node("text.count")
def count() -> int:
    return 1


@pytest.mark.parametrize(
    ("smooth", "says"),
    [
        ("smooth.whole", "over the whole take"),
        ("smooth.window", "by 2 frames"),
        ("{use: smooth.window, with: {reach: $k}}", "by 3 frames"),
        ("{use: smooth.window, with: {reach: 1}}", "by 1 frame,"),
        ("{use: smooth.window, with: {reach: 0}}", ""),
        ("smooth.causal", ""),
        ("fill.scale", ""),
    ],
)
def test_a_method_that_looks_ahead_of_a_cut_is_named(
    graph_of: Callable[..., Graph], smooth: str, says: str
) -> None:
    written = TEXT.format(smooth=smooth, damage="gaps.cut")
    if "$k" not in smooth:
        written = written.replace("axes: {k: [0, 3]}", "")
    notices = graph_of(written, more=(*MORE, count)).notices
    assert [notice.place.line for notice in notices] == ([6] if says else [])
    for notice in notices:
        assert f"looks ahead {says}" in notice.message
        assert "smooth (smooth." in notice.message
        assert "damage" in notice.message


def test_noise_hides_no_samples(graph_of: Callable[..., Graph]) -> None:
    written = TEXT.format(smooth="smooth.whole", damage="noise.add")
    assert not graph_of(written.replace("axes: {k: [0, 3]}", ""), more=(*MORE, count)).notices


def test_a_notice_is_in_the_record_of_the_run(run_of: Callable[..., Run]) -> None:
    written = TEXT.format(smooth="smooth.whole", damage="gaps.cut")
    run = run_of(written.replace("axes: {k: [0, 3]}", ""), more=(*MORE, count))
    graph = run.plan.graph
    (notice,) = record(run).notices
    assert notice.place == str(graph.notices[0].place)
    assert notice.message == graph.notices[0].message
