"""Keys, also of files that change during a run."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Any

import numpy as np
import pytest
from pydantic import AfterValidator

from nodegraph import Across, InputFile, NodegraphError, hookimpl, node
from nodegraph.execute.events import Event
from nodegraph.execute.results import Run
from nodegraph.plugin.kind import Kind
from nodegraph.plugin.loading import Plugin
from nodegraph.store import Packer, Store

RunOf = Callable[..., Run]
TEXT = "nodes: {a: {use: read.file, with: {path: one.txt}}, b: {use: fill.hold, in: a}}"


def write(path: Path, content: str) -> Callable[[Event], None]:
    """Return a listener that writes a file when the first step starts."""

    def listen(event: Event) -> None:
        if event.kind == "started" and event.node == "a":
            path.write_text(content)

    return listen


def test_nothing_is_stored_of_a_file_that_changed_while_it_was_read(
    run_of: RunOf, tmp_path: Path
) -> None:
    path, store = tmp_path / "one.txt", tmp_path / "store"
    path.write_text("1")
    changed = run_of(TEXT, store=store, listeners=[write(path, "50")])
    assert changed["b"].value == 51
    assert changed.cache is not None
    assert dict(changed.cache.not_stored) == {
        "a file changed while it was read": 1,
        "they are made of results that are not stored": 1,
    }
    path.write_text("1")
    assert run_of(TEXT, store=store)["b"].value == 2


@pytest.mark.parametrize(
    "known", [None, 5, [], [[1, 2, 3]], ["mark"], ["mark", "x", "y"], {"mark": "x"}]
)
def test_what_is_remembered_of_a_file_in_another_form_is_found_anew(
    run_of: RunOf, tmp_path: Path, known: object
) -> None:
    path, store = tmp_path / "one.txt", Store(tmp_path / "store", Packer(), pytest.fail)
    path.write_text("1")
    os.utime(path, (0, 0))
    assert run_of(TEXT, store=store.folder)["b"].value == 2
    mark = store.recall("files")[str(path)][0]
    if isinstance(known, list):
        known = [mark if part == "mark" else part for part in known]
    store.remember("files", {str(path): known})
    again = run_of(TEXT, store=store.folder)
    assert again["b"].value == 2
    assert again.counts()["stored"] == 2


@node("add.signed")
def signed(plus: float | None = None, minus: float | None = None) -> float:
    return (plus or 0.0) - (minus or 0.0)


def test_a_result_is_not_that_of_another_port(run_of: RunOf, tmp_path: Path) -> None:
    text = "nodes: {{n: {{use: read.number}}, s: {{use: add.signed, in: {{{port}: n}}}}}}"
    runs = {
        port: run_of(text.format(port=port), store=tmp_path / "store", more=[signed])
        for port in ("plus", "minus")
    }
    assert runs["minus"]["n"].value != 0.0
    assert runs["minus"]["s"].value == -runs["plus"]["s"].value


def test_a_result_is_found_again_for_the_same_content_under_another_name(
    run_of: RunOf, tmp_path: Path
) -> None:
    for name in ("one.txt", "two.txt"):
        (tmp_path / name).write_text("1")
    run_of(TEXT, store=tmp_path / "store")
    again = run_of(TEXT.replace("one.txt", "two.txt"), store=tmp_path / "store")
    assert again.counts()["stored"] == 2


@node("read.last")
def read_last(*, path: InputFile) -> float:
    number = float(path.read_text())
    path.unlink()
    return number


def test_a_file_that_is_removed_while_it_is_read_costs_the_stored_result_only(
    run_of: RunOf, tmp_path: Path
) -> None:
    (tmp_path / "one.txt").write_text("1")
    text = TEXT.replace("read.file", "read.last")
    run = run_of(text, store=tmp_path / "store", more=[read_last])
    assert (run["b"].value, run.counts()["done"]) == (2, 2)


@node("read.many")
def read_many(*, path: InputFile) -> np.ndarray:
    return np.full(3000, float(path.read_text()))


@node("sum.many")
def sum_many(many: np.ndarray) -> float:
    return float(many.sum())


def test_a_value_is_not_computed_again_of_another_file(run_of: RunOf, tmp_path: Path) -> None:
    path, store, messages = tmp_path / "one.txt", tmp_path / "store", list[str]()
    path.write_text("1")
    text = TEXT.replace("read.file", "read.many").replace("fill.hold", "sum.many")
    run = run_of(text, store=store, say=messages.append, more=[read_many, sum_many])
    [blob] = store.glob("*/blobs/*")
    blob.unlink()
    path.write_text("50")
    for _ in range(2):
        with pytest.raises(NodegraphError, match="a file or code that it needs has changed"):
            run["a"].at()
    assert (run["b"].value, len(messages)) == (3000, 1)
    path.write_text("1")
    assert run["a"].value[0] == 1


class Picture:
    """What only a stand-in is kept of."""

    def __init__(self, text: str) -> None:
        self.text = text


PICTURES = Kind(
    Picture,
    take_apart=lambda picture: picture.text,
    put_together=lambda text: Picture("stand-in"),
    faithful=False,
)
TIMES: Counter[float] = Counter()


@node("read.shaky")
def shaky(*, start: float) -> float:
    TIMES[start] += 1
    if start == 2 and TIMES[start] == 2:
        raise ValueError("just this once")
    return start


@node("sum.all")
def sum_all(parts: Across[float]) -> float:
    return sum(value for _, value in parts)


@node("picture.draw")
def draw(number: float) -> Picture:
    return Picture(f"{number:g}")


@node("picture.label")
def label(picture: Picture, *, unit: str) -> str:
    return picture.text + unit


def test_a_result_is_stored_for_what_was_gathered_and_not_for_what_was_expected(
    run_of: RunOf, tmp_path: Path
) -> None:
    text = """
        axes: {start: [1, 2]}
        nodes:
          a: {use: read.shaky, with: {start: $start}}
          b: {use: sum.all, in: a}
          c: {use: picture.draw, in: b}
          d: {use: picture.label, in: c, with: {unit: mm}}
        """
    module = SimpleNamespace(__name__="pictures", nodegraph_kinds=hookimpl(lambda: [PICTURES]))
    more = {
        "more": [shaky, sum_all, draw, label],
        "plugins": [Plugin("pictures", module)],
        "store": tmp_path,
    }
    TIMES.clear()
    first = run_of(text, **more)
    for name, at in (("a", (2,)), ("b", ())):
        key = first.outcomes[first.plan.cells[name][at]].key
        next(tmp_path.rglob(f"{key}.json")).unlink()
    text = text.replace("mm", "cm")
    assert run_of(text, **more)["d"].value == "1cm"
    assert run_of(text, **more)["d"].value == "3cm"


@node("labels.all")
def all_labels(parts: Across[float]) -> str:
    return ", ".join(str(label) for label in parts.labels("parts"))


def test_a_node_knows_labels_that_it_does_not_gather_and_its_key_knows_them_too(
    run_of: RunOf, tmp_path: Path
) -> None:
    text = """
        axes: {start: [10, 20]}
        nodes:
          a: {use: read.shaky, with: {start: $start}}
          b: {use: labels.all, in: {parts: {"20": {from: a, at: {start: 20}}}}}
        """
    more = {"more": [shaky, all_labels], "store": tmp_path}
    TIMES.clear()
    assert run_of(text, **more)["b"].value == "10, 20"
    assert run_of(text.replace("20]", "20, 30]"), **more)["b"].value == "10, 20, 30"
    assert TIMES[20] == 1


def test_what_gathers_is_computed_anew_for_other_values(run_of: RunOf, tmp_path: Path) -> None:
    text = """
        axes: {power: [1.0, 2.0]}
        nodes:
          a: {use: read.file, with: {path: one.txt}}
          b: {use: fill.scale, in: a, with: {power: $power}}
          c: {use: sum.all, in: b}
        """
    for content, total in (("2", 6), ("3", 9)):
        (tmp_path / "one.txt").write_text(content)
        assert run_of(text, more=[sum_all], store=tmp_path / "store")["c"].value == total


@node("read.folder")
def read_folder(*, path: InputFile) -> str:
    return " ".join(f"{file.name}={file.read_text()}" for file in sorted(path.iterdir()))


def test_a_folder_is_read_again_if_a_file_in_it_has_another_content_or_name(
    run_of: RunOf, tmp_path: Path
) -> None:
    folder, more = tmp_path / "takes", {"more": [read_folder], "store": tmp_path / "store"}
    text = "nodes: {a: {use: read.folder, with: {path: takes}}}"
    folder.mkdir()
    (folder / "a.txt").write_text("1")
    assert run_of(text, **more)["a"].value == "a.txt=1"
    assert run_of(text, **more).counts()["stored"] == 1
    (folder / "a.txt").write_text("2")
    assert run_of(text, **more)["a"].value == "a.txt=2"
    (folder / "a.txt").rename(folder / "b.txt")
    assert run_of(text, **more)["a"].value == "b.txt=2"


class Unnamed:
    def __init__(self, value: object) -> None:
        self.value = value


@node("read.unnamed")
def read_unnamed(*, value: Annotated[Any, AfterValidator(Unnamed)]) -> str:
    return str(value.value)


def test_a_setting_whose_text_is_an_address_is_in_no_key(run_of: RunOf, tmp_path: Path) -> None:
    for value in ("first", "second"):
        text = f"nodes: {{a: {{use: read.unnamed, with: {{value: {value}}}}}}}"
        run = run_of(text, more=[read_unnamed], store=tmp_path)
        assert run["a"].value == value
        assert run.cache is not None
        assert dict(run.cache.not_stored) == {"read.unnamed: a setting has no lasting text": 1}
