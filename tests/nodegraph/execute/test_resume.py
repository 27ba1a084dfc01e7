"""A stored result is not computed again, unless something that decides it has changed."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace

import numpy as np
import pytest

from nodegraph import hookimpl, node
from nodegraph.execute.events import Event
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.results import Run
from nodegraph.plugin.kind import Kind
from nodegraph.plugin.loading import Plugin
from nodegraph.store import Store

RunOf = Callable[..., Run]
WAYS = [HowToRun("serial"), HowToRun("threads", 3)]
STUDY = """
axes: {trial: {count: 4}, length: [5, 15]}
nodes:
  capture: {use: read.number, with: {start: 20}}
  gaps: {use: gaps.cut, in: capture, with: {length: $length, seed: $trial}}
  fill: {in: gaps, alternatives: {hold: fill.hold, scale: fill.scale, pass: {}}}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
  table: {use: compare.table, in: error}
"""
SHORT = "nodes: {a: {use: read.number}, b: {use: fill.hold, in: a}}"
MADE: list[str] = []
PICKY = """
axes: {start: [-1, 1, 2]}
nodes:
  a: {use: read.number, with: {start: $start}}
  b: {use: strict.positive, in: a}
  c: {use: fill.hold, in: b}
  d: {use: compare.table, in: c}
"""


@pytest.mark.parametrize("how", WAYS)
def test_a_second_run_computes_nothing(
    run_of: RunOf, calls: list[str], tmp_path: Path, how: HowToRun
) -> None:
    first = run_of(STUDY, store=tmp_path, how=how)
    assert first.counts()["done"] == len(first.plan.steps) == 58
    calls.clear()
    second = run_of(STUDY, store=tmp_path, how=how)
    assert second.counts()["stored"] == 58
    assert calls == []
    assert second["table"].value == first["table"].value == run_of(STUDY)["table"].value
    assert list(second["fill"]) == list(first["fill"])


def test_only_values_that_are_used_are_read(
    run_of: RunOf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_of(STUDY, store=tmp_path)
    with monkeypatch.context() as patched:
        patched.setattr(Store, "load", lambda *_: pytest.fail("read"))
        run = run_of(STUDY, store=tmp_path)
    assert run["error"].at(trial=0, length=5, fill="hold") > 0


def test_a_setting_reruns_what_depends_on_it(
    run_of: RunOf, calls: list[str], tmp_path: Path
) -> None:
    run_of(STUDY, store=tmp_path)
    calls.clear()
    run = run_of(STUDY.replace("[5, 15]", "[5, 16]"), store=tmp_path)
    assert calls.count("gaps.cut") == 4
    assert calls.count("fill.hold") == 4
    assert calls.count("score.gaps") == 12
    assert calls.count("compare.table") == 1
    assert "read.number" not in calls
    assert run.counts() == {**run.counts(), "done": 4 + 12 + 12 + 1, "stored": 1 + 4 + 12 + 12}


def test_another_method_leaves_the_others_as_they_are(
    run_of: RunOf, calls: list[str], tmp_path: Path
) -> None:
    run_of(STUDY.replace("hold: fill.hold, ", ""), store=tmp_path)
    calls.clear()
    run_of(STUDY, store=tmp_path)
    assert calls == [*["fill.hold", "score.gaps"] * 8, "compare.table"]


def test_a_name_in_the_graph_decides_nothing(
    run_of: RunOf, calls: list[str], tmp_path: Path
) -> None:
    run_of("nodes: {a: {use: read.number}, b: {use: fill.hold, in: a}}", store=tmp_path)
    calls.clear()
    run = run_of("nodes: {x: {use: read.number}, y: {use: fill.hold, in: x}}", store=tmp_path)
    assert (calls, run["y"].value) == ([], 2.0)


def test_the_content_of_a_file_decides_and_not_its_name(run_of: RunOf, tmp_path: Path) -> None:
    text = "nodes: {a: {use: read.file, with: {path: one.txt}}, b: {use: fill.hold, in: a}}"
    (tmp_path / "one.txt").write_text("1")
    store = tmp_path / "store"
    assert run_of(text, store=store)["b"].value == 2
    (tmp_path / "two.txt").write_text("1")
    assert run_of(text.replace("one", "two"), store=store).counts()["stored"] == 2
    (tmp_path / "one.txt").write_text("3")
    changed = run_of(text, store=store)
    assert (changed.counts()["done"], changed["b"].value) == (2, 4)
    (tmp_path / "one.dat").write_text("3")
    assert run_of(text.replace("one.txt", "one.dat"), store=store).counts()["done"] == 2


@node("reads.file")
def read_unnamed_file(*, name: str) -> str:
    return Path(name).read_text()


@node("reads.variable")
def read_variable() -> str:
    return os.environ.get("NODEGRAPH_TEST", "")


@node("reads.folder")
def list_unnamed_folder(*, name: str) -> str:
    return str(sorted(each.name for each in Path(name).iterdir()))


@node("reads.own_folder")
def list_own_folder() -> str:
    with TemporaryDirectory() as folder:
        (Path(folder) / "mine.txt").write_text("1")
        return str(os.listdir(folder))


@pytest.mark.parametrize("how", [*WAYS, HowToRun("processes", 1)])
def test_what_a_node_reads_that_no_setting_names_is_never_stale(
    run_of: RunOf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, how: HowToRun
) -> None:
    text = f"""
        nodes:
          a: {{use: reads.file, with: {{name: {tmp_path}/a.txt}}}}
          b: {{use: reads.variable}}
          c: {{use: reads.folder, with: {{name: {tmp_path}/in}}}}
          d: {{use: reads.own_folder}}
    """
    for content in ("1", "2"):
        (tmp_path / "a.txt").write_text(content)
        (tmp_path / "in" / content).mkdir(parents=True)
        monkeypatch.setenv("NODEGRAPH_TEST", content)
        more = [read_unnamed_file, read_variable, list_unnamed_folder, list_own_folder]
        run = run_of(text, more=more, store=tmp_path / "store", how=how)
        assert (run["a"].value, run["b"].value) == (content, content)
        assert content in run["c"].value
        why = "which no setting names, so that nothing would say when it changes"
        assert sorted(run.not_stored()) == [
            f"1 result is not stored: reads.file reads a.txt, {why}",
            f"1 result is not stored: reads.folder reads in/, {why}",
            f"1 result is not stored: reads.variable reads $NODEGRAPH_TEST, {why}",
        ]


def test_a_refusal_is_stored_with_what_it_makes_of_a_gathering(
    run_of: RunOf, calls: list[str], tmp_path: Path
) -> None:
    first = run_of(PICKY, store=tmp_path)
    assert first.counts() == {
        "done": 8, "stored": 0, "refused": 1, "failed": 0, "skipped": 1, "unneeded": 0
    }  # fmt: skip
    calls.clear()
    second = run_of(PICKY, store=tmp_path)
    assert calls == []
    assert second.counts()["refused"] == 1
    assert second.counts()["stored"] == 8
    assert second["d"].value == first["d"].value
    absent = second["d"].value.scores.absent
    assert [(entry.labels, entry.kind) for entry in absent] == [({"start": -1}, "refused")]


def test_a_failure_is_tried_again_and_changes_only_what_gathers_it(
    run_of: RunOf, calls: list[str], tmp_path: Path
) -> None:
    text = PICKY.replace("strict.positive", "strict.fails")
    first = run_of(text, store=tmp_path)
    assert (first.counts()["failed"], first.counts()["skipped"]) == (1, 1)
    calls.clear()
    second = run_of(text, store=tmp_path)
    assert (second.counts()["failed"], second.counts()["done"]) == (1, 0)
    assert calls == []
    whole = run_of(text.replace("-1, ", ""), store=tmp_path)
    assert calls == ["compare.table"]
    assert len(whole["d"].value.scores) == 2


def test_what_stands_between_stored_results_is_not_needed(
    run_of: RunOf, calls: list[str], tmp_path: Path
) -> None:
    first = run_of(STUDY, store=tmp_path)
    for step in first.plan.steps:
        if step.node in ("gaps", "fill"):
            entry_of(tmp_path, first.outcomes[step.index].key).unlink(missing_ok=True)
    calls.clear()
    second = run_of(STUDY, store=tmp_path)
    assert calls == []
    assert second.counts()["unneeded"] == 8 + 24
    assert second["fill"].at(trial=0, length=5, fill="hold") == 16
    assert calls == ["gaps.cut", "fill.hold"]


@pytest.mark.parametrize("how", WAYS)
def test_one_key_is_computed_once_in_a_run(
    run_of: RunOf, calls: list[str], tmp_path: Path, how: HowToRun
) -> None:
    text = """
        nodes:
          a: {alternatives: {one: {use: read.number}, two: {use: "toys:read.number"}}}
          b: {use: fill.hold, in: a}
        """
    run = run_of(text, store=tmp_path, how=how)
    assert calls == ["read.number", "fill.hold"]
    assert [value for _, value in run["b"]] == [2, 2]


@pytest.fixture
def called() -> list[str]:
    """Names of the nodes of this file that have been called."""
    MADE.clear()
    return MADE


RAMPS = """
nodes:
  a: {use: array.ramp}
  b: {use: array.sum, in: a, with: {add: 1}}
  c: {use: array.sum, in: a, with: {add: 2}}
"""


@pytest.mark.parametrize("what", ["entry", "blob"])
@pytest.mark.parametrize("how", WAYS)
def test_a_damaged_result_is_computed_again_and_reported(
    run_of: RunOf, called: list[str], tmp_path: Path, what: str, how: HowToRun
) -> None:
    first = run_of(RAMPS, more=ARRAYS, store=tmp_path)
    if what == "entry":
        damaged = entry_of(tmp_path, first.outcomes[first.plan.cells["a"][()]].key)
    else:
        [damaged] = (path for path in tmp_path.rglob("blobs/*") if path.is_file())
    damaged.write_bytes(damaged.read_bytes()[:-20])
    called.clear()
    messages: list[str] = []
    changed = RAMPS.replace("add: 1", "add: 3").replace("add: 2", "add: 4")
    run = run_of(changed, more=ARRAYS, store=tmp_path, say=messages.append, how=how)
    total = sum(range(3000))
    assert (run["b"].value, run["c"].value) == (total + 3, total + 4)
    assert called == ["array.ramp"]
    assert len(messages) == 1
    assert "computed again" in messages[0]
    called.clear()
    assert run_of(changed, more=ARRAYS, store=tmp_path).counts()["stored"] == 3


def test_what_is_damaged_when_it_is_asked_for_is_computed_again(
    run_of: RunOf, called: list[str], tmp_path: Path
) -> None:
    run_of(RAMPS, more=ARRAYS, store=tmp_path)
    messages: list[str] = []
    run = run_of(RAMPS, more=ARRAYS, store=tmp_path, say=messages.append)
    for path in tmp_path.rglob("blobs/*"):
        path.write_bytes(b"")
    called.clear()
    assert run["a"].value.sum() == sum(range(3000))
    assert (called, len(messages)) == (["array.ramp"], 1)


@pytest.mark.parametrize("how", WAYS)
def test_a_stand_in_is_shown_and_never_given_to_a_reader(
    run_of: RunOf, called: list[str], tmp_path: Path, how: HowToRun
) -> None:
    text = """
        nodes:
          a: {use: picture.draw, with: {x: 2}}
          b: {use: picture.size, in: a, with: {add: 1}}
          c: {use: picture.size, in: a, with: {add: 1.5}}
        report: [a, b, c]
        """
    module = SimpleNamespace(__name__="pictures", nodegraph_kinds=hookimpl(lambda: [PICTURES]))
    plugin = Plugin("pictures", module)
    more = {"more": (draw, size), "plugins": [plugin], "store": tmp_path, "how": how}
    run_of(text, **more)
    called.clear()
    second = run_of(text, **more)
    assert called == []
    assert [value for _, value in second["a"].shown()] == ["a picture of 2"]
    assert second["a"].value.text == "2"
    assert called == ["picture.draw"]
    called.clear()
    third = run_of(text.replace("add: 1}", "add: 3}"), **more)
    assert called == ["picture.draw"]
    assert third["b"].value == 4


def test_events_list_what_was_stored(
    run_of: RunOf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("nodegraph.execute.events._INTERVAL", 0.0)
    events: list[Event] = []
    run_of(PICKY, store=tmp_path)
    run_of(PICKY.replace("fill.hold", "fill.scale"), store=tmp_path, listeners=[events.append])
    kinds = [event.kind for event in events if event.kind != "progress"]
    assert Counter(kinds[:7]) == {"planned": 1, "stored": 5, "refused": 1}
    assert kinds[7:] == ["skipped", *["started", "done"] * 3, "finished"]
    refused = next(event for event in events if event.kind == "refused")
    assert refused.detail["stored"] is True
    last = [event.detail for event in events if event.kind == "progress"][-1]
    assert last == {
        "run": 3, "stored": 5, "refused": 1, "failed": 0, "skipped": 1, "unneeded": 0,
        "left": 0, "to_go": None,
    }  # fmt: skip


def entry_of(folder: Path, key: str) -> Path:
    """Return the file of an entry."""
    return next(folder.rglob(f"{key}.json"), folder / "none")


@node("array.ramp")
def ramp(*, size: int = 3000) -> np.ndarray:
    MADE.append("array.ramp")
    return np.arange(float(size))


@node("array.sum")
def add_up(x: np.ndarray, *, add: int = 0) -> float:
    return float(x.sum()) + add


ARRAYS = (ramp, add_up)


class Picture:
    """What only a stand-in is kept of."""

    def __init__(self, text: str) -> None:
        self.text = text


PICTURES = Kind(
    Picture,
    take_apart=lambda picture: picture.text,
    put_together=lambda text: f"a picture of {text}",
    faithful=False,
)


@node("picture.draw")
def draw(*, x: float) -> Picture:
    MADE.append("picture.draw")
    return Picture(f"{x:g}")


@node("picture.size")
def size(picture: Picture, *, add: float = 0.0) -> float:
    return len(picture.text) + add


def test_each_reason_why_results_are_not_stored_is_counted(run_of: RunOf, tmp_path: Path) -> None:
    first = run_of(SHORT, store=tmp_path)
    assert first.cache is not None
    assert first.not_stored() == []
    first.cache.distrust(first.plan.steps[0], "a second call")
    later = run_of(SHORT, store=tmp_path)
    assert later.not_stored() == [
        "1 result is not stored: read.number: an audit found that it gives another answer in a "
        "second call",
        "1 result is not stored: they are made of results that are not stored",
    ]
    assert later.cache is not None
    assert [later.cache.distrusted(step) for step in later.plan.steps] == [
        "an audit found that it gives another answer in a second call",
        "",
    ]


def test_a_run_without_a_store_gives_no_reasons(run_of: RunOf) -> None:
    assert run_of(SHORT).not_stored() == []
