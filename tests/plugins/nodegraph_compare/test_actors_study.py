"""Studies over actors from the command line: units, refusals, suspect blocks, bad input."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from nodegraph.cli.main import main

NODES = '''
from typing import Annotated

from nodegraph import Columns, Value, node
from nodegraph_mocap import Table
from nodegraph_tables import TableInfo, with_info
import numpy as np
import pandas as pd
from dataclasses import dataclass


@dataclass(frozen=True)
class Take(Value):
    """An actor."""

    seed: int


@node("made.take", cite="none")
def take(*, seed: int = 0) -> Take:
    """Return a take.

    Parameters
    ----------
    seed
        Of the actor.
    """
    return Take(seed)


def ahead(settings):
    """Return the look-ahead in frames."""
    return None if settings["kind"] == "plain" else 3


@node("made.error", cite="none", lookahead=ahead)
def error(take: Take, *, kind: str = "plain", trial: int = 0, broken: bool = False) -> Annotated[
    Table, Columns("gap", "marker", "rmse")
]:
    """Score ten gaps: `shy` leaves the hardest 40 % and is far worse than `plain` there.

    Parameters
    ----------
    kind
        Of the method.
    trial
        Draws the gaps.
    broken
        Whether a gap of the first actor has a wrong truth.
    """
    random = np.random.default_rng([take.seed, trial])
    actor = np.random.default_rng(take.seed).normal(0, 0.3)
    hard = np.exp(actor + random.normal(size=10))
    noise = np.random.default_rng([take.seed, trial, sum(map(ord, kind))]).lognormal(0, 0.2, 10)
    rmse = {
        "plain": hard, "other": 1.3 * hard, "shy": np.where(hard > 1.3, np.nan, 0.6 * hard),
        "few": 1.3 * hard if take.seed < 3 else np.full(10, np.nan),
    }[kind] * noise
    if broken and take.seed == 0 and trial == 0:
        rmse = rmse.copy()
        rmse[7] = 1e4
    table = pd.DataFrame({"gap": range(10), "marker": "chin", "rmse": rmse})
    return with_info(table, TableInfo(units={"rmse": "mm"}))
'''
GRAPH = """
nodegraph: 1
axes:
  actor: {{count: {actors}}}
  trial: [0, 1]
nodes:
  take: {{use: made.take, with: {{seed: $actor}}}}
  error:
    in: take
    with: {{trial: $trial, broken: {broken}}}
    alternatives:
      other: {{use: made.error, with: {{kind: other}}}}
      plain: {{use: made.error, with: {{kind: plain}}}}
      {third}: {{use: made.error, with: {{kind: {third}}}}}
  answer: {{use: {use}, in: error, with: {{metric: rmse, blocks: [trial, gap], {more}}}}}
report: [answer]
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> object:
    """Return what runs the graph and gives the exit status."""
    folder = tmp_path_factory.mktemp("study")
    (folder / "made.py").write_text(NODES)

    def run_graph(more: str = "", *words: str, **settings: object) -> int:
        values = {
            "actors": 8,
            "broken": "false",
            "use": "compare.table",
            "more": more,
            "third": "shy",
        }
        (folder / "graph.yaml").write_text(GRAPH.format(**{**values, "more": more, **settings}))
        command = ["run", str(folder / "graph.yaml"), "--plugin", str(folder / "made.py"), "--full"]
        return main([*command, *words, "--out", str(folder / "run"), "--jobs", "1"])

    return run_graph


def test_a_method_that_refuses_the_hardest_blocks_does_not_win_unseen(
    run: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run() == 0
    text = capsys.readouterr().out
    assert "shy is best (" in text
    assert "8 actors: holds for further actors." in text
    assert re.search(r"\d+ of 160 blocks left out \(shy lacks \d+\)", text)
    assert run("fallback: other") == 0
    text = capsys.readouterr().out
    assert "plain " in text
    assert "the rules for missing blocks disagree: over common gaps shy has the best mean" in text
    assert "mean, worst of block" in text
    assert re.search(r"plain +.* whole take", text)
    assert re.search(r"shy +.* 3 frames", text)
    assert run("fallback: other", use="compare.ranks") == 0
    text = capsys.readouterr().out
    assert "missing gaps as by other (shy" in text
    assert "why: over common gaps shy has the lowest mean rank" in text
    assert run("fallback: other, equivalent: 1.05", use="compare.bayes") == 0
    only = r"undecided: .*shy \(worse: \d.\d+, only with other in place of missing gaps\)"
    assert re.search(only, capsys.readouterr().out)


def test_a_method_that_lacks_whole_actors_withdraws_only_what_rests_on_them(
    run: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("fallback: plain", third="few") == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "the rules for missing blocks disagree" not in text
    assert "Lowest mean rmse: plain (" in text
    assert "The data cannot tell which is best: no difference is clear" in text
    assert re.search(r"clearly behind only with plain in place of missing gaps: .*other", text)


def test_a_block_in_which_every_method_fails_is_named(
    run: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("fallback: plain", broken="true") == 0
    text = capsys.readouterr().out
    assert "without suspect gaps" in text
    assert "(actor 0, trial 0, gap 7, marker chin: every method errs much)" in text


@pytest.mark.parametrize(
    ("more", "status", "parts"),
    [
        ("clusters: [trial]", 2, ("same data", "'trial'", "differ: actor")),
        ("clusters: [error], compare: error", 2, ("clusters and compare share a name: 'error'",)),
        ("clusters: [actr]", 2, ("no axis or column 'actr'", "'actor'")),
        ("fallback: sy", 2, ("fallback", "no label 'sy'", "'shy'")),
        ("equivalent: 0.9", 2, ("'equivalent'", "above 1", "0.05 mm")),
        (f"equivalent: {'1' * 400} mm", 2, ("'equivalent'", "above 0")),
        ("equivalent: 0 mm", 2, ("'equivalent'", "above 0")),
    ],
)
def test_bad_settings_are_refused_with_what_there_is(
    run: Callable[..., int],
    capsys: pytest.CaptureFixture[str],
    more: str,
    status: int,
    parts: tuple[str, ...],
) -> None:
    assert run(more) == status
    captured = capsys.readouterr()
    assert all(part in captured.out + captured.err for part in parts)


def test_clusters_of_one_label_are_refused(
    run: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("clusters: [actor]", "--axis", "actor=[3]") == 2
    assert "'actor' has one label, 3" in capsys.readouterr().err
