"""The pages show runs in whatever state they are, and nothing else of this machine."""

from __future__ import annotations

import gzip
import html
import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import pytest

import nodegraph as ng
from nodegraph.runs.folder import RunFolder
from tests.nodegraph.serve.conftest import Pages
from tests.nodegraph.serve.requests import Answer
from tests.texts import edit

Opened = Callable[..., Pages]
RUN = Path("runs/toy")
VALUE = urlencode({"run": "toy", "node": "fill", "at.start": 1, "at.fill": "hold"})
BLOCK = {
    "run": "toy",
    "node": "table",
    "compare": "fill",
    "methods": json.dumps(["hold", "<u>"]),
    "block": json.dumps({"start": 5, "gap": 3}),
}


def shown(answer: Answer) -> str:
    """Return a page, which runs no script but its own and fetches from nowhere else."""
    page = answer.text
    policy = answer.headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "connect-src 'self'" in policy
    assert not re.search(r"script-src [^;]*(unsafe|\*|http)", policy)
    assert "<script>bad" not in page
    assert "<u>" not in page
    assert "Traceback" not in page
    return page


def computed(answer: Answer) -> list[Any]:
    """Return the lines of a computation."""
    assert answer.status == 200, answer.text
    return [json.loads(line) for line in answer.text.splitlines()]


def test_the_report_is_that_of_the_file_with_a_server_behind_it(opened: Opened) -> None:
    page = shown(opened().get("/"))
    assert "&lt;script&gt;bad()" in page
    assert 'nodegraph.define("server", ["page"]' in page
    assert 'href="./files/0/run.json"' in page


@pytest.mark.parametrize(
    "name",
    [
        "../../toys.py", "..%2f..%2ftoys.py", "%2e%2e/%2e%2e/toys.py", "/etc/passwd", "toys.py", "",
        "..%5c..%5ctoys.py", "run.json/../../../toys.py", "study.json.gz%00", ".",
    ],
)  # fmt: skip
def test_files_are_those_that_the_report_lists(opened: Opened, name: str) -> None:
    pages = opened()
    assert json.loads(pages.get("/files/0/run.json").body)["format"] == 2
    answer = pages.get(f"/files/0/{name}")
    assert answer.status == 404
    assert b"toy.number" not in answer.body
    assert pages.get("/files/1/run.json").status == 404


def test_files_that_a_study_links_outside_its_folder_are_not_given(opened: Opened) -> None:
    study = json.loads(gzip.decompress((RUN / "study.json.gz").read_bytes()))
    study["files"][0]["path"] = "../../toys.py"
    (RUN / "study.json.gz").write_bytes(gzip.compress(json.dumps(study).encode()))
    (RUN / "events.jsonl").unlink()
    (RUN / "events.jsonl").symlink_to(Path("toys.py").absolute())
    pages = opened()
    shown(pages.get("/"))
    assert pages.get("/files/0/../../toys.py").status == 404
    assert pages.get("/files/0/events.jsonl").status == 404


def test_any_value_is_shown_and_saved(opened: Opened) -> None:
    pages = opened()
    page = shown(pages.get(f"/value?{VALUE}"))
    assert "start=1, fill=hold" in page
    assert '<pre tabindex="0">2.0</pre>' in page
    error = shown(pages.get(f"/value?{VALUE.replace('node=fill', 'node=error')}"))
    assert "error: 1.0" in error


def states_in(page: str) -> Any:
    """Return the states of nodes that a page has."""
    (data,) = re.findall(r'data-snapshot="([^"]*)"', page)
    return json.loads(html.unescape(data))


def test_a_graph_has_the_states_of_its_steps(opened: Opened) -> None:
    page = shown(opened().get("/values?run=toy"))
    assert 'data-box="fill"' in page
    assert 'data-alternative="hold"' in page
    known = states_in(page)
    states = {**known["nodes"], **known["alternatives"]}
    assert [(name, each["mark"], each["text"]) for name, each in states.items()] == [
        ("a", "done", "2 done"),
        ("fill", "refused", "1 of 4 refused, 3 done"),
        ("error", "skipped", "1 of 4 skipped, 3 done"),
        ("table", "done", "1 done"),
        ("fill=hold", "done", "2 done"),
        ("fill=<u>", "refused", "1 of 2 refused, 1 done"),
    ]


def test_combinations_are_listed_with_states_and_reasons(opened: Opened) -> None:
    pages = opened()
    page = shown(pages.get("/values?run=toy&node=fill"))
    assert re.search(r"2 methods, \S*toy.yaml:6:", page)
    rows = re.findall("<tr><th scope=.row.>(.*?)</th><td>(.*?)</td><td>(.*?)</td></tr>", page)
    assert rows[0] == ("start=5, fill=&lt;u&gt;", "refused", "too large")
    assert [(state, reason) for _, state, reason in rows[1:]] == [("done", "")] * 3
    chosen = shown(pages.get("/values?run=toy&node=fill&at.start=1&at.fill=hold&state="))
    (address,) = re.findall(r'<a href="(/value\?.*?)">start=1, fill=hold</a>', chosen)
    assert '<pre tabindex="0">2.0</pre>' in shown(pages.get(address.replace("&amp;", "&")))
    assert "4 combinations" in page
    assert "1 combination<" in chosen
    assert "no node &#39;nowhere&#39;" in shown(pages.get("/values?run=toy&node=nowhere"))


def test_a_graph_that_cannot_be_built_is_a_message_beside_its_states(opened: Opened) -> None:
    page = shown(opened(plugins=()).get("/values?run=toy"))
    assert re.search(r"not drawn: .*--plugin \S*toys.py", page)
    assert states_in(page)["nodes"]["a"]["text"] == "2 done"


def test_a_link_says_what_flows_on_it(opened: Opened) -> None:
    pages, link = opened(), "/flow?run=toy&link=fill.output+error.estimate"
    facts, store = ["3 values, float", "size 1 to 6 mm", "names 2"], Path("store").absolute()
    assert pages.get(link).data == [*facts, f"read from {store}"]
    shutil.rmtree("store")
    assert pages.get(link).data == [facts[0], "3 of 3 looked up are not stored"]
    answer = pages.get("/flow?run=toy&link=fill.output")
    assert (answer.status, answer.data["message"]) == (409, "the graph has no link 'fill.output'")


def test_of_many_values_some_are_read_for_their_facts(opened: Opened) -> None:
    graph = ng.load("toy.yaml", plugins=["toys.py"], axis={"start": list(range(40))})
    ng.run(graph, store="store").save("runs/many")
    data = opened("runs/many").get("/flow?run=many&link=a.output+fill.x").data
    assert data[:2] == ["40 values, float", "size 0 to 39 mm"]
    assert data[-1] == f"read 12 of 40 from {Path('store').absolute()}"


@pytest.mark.parametrize(
    ("query", "names"),
    [
        ("run=nowhere", ["nowhere", "toy"]),
        ("run=toy&node=nowhere", ["nowhere", "table"]),
        ("run=toy&node=fill.nowhere", ["nowhere", "output"]),
        ("run=toy&node=fill&at.start=7&at.fill=hold", ["7", "1, 5"]),
        ("run=toy&node=fill&at.start=1", ["fill", "hold"]),
        ("run=toy&node=a&at.start=1&at.odd=1", ["odd", "start"]),
        ("run=toy&node=fill&at.start=5&at.fill=%3Cu%3E", ["refused", "too large"]),
    ],
)
def test_what_there_is_not_is_a_message(opened: Opened, query: str, names: list[str]) -> None:
    answer = opened().get(f"/value?{query}")
    assert answer.status in (404, 409)
    page = shown(answer)
    assert all(name in page for name in names)


def test_a_value_without_a_renderer_is_shown_as_files_are(opened: Opened) -> None:
    pages = opened()
    exact = shown(pages.get("/value?run=toy&node=error&at.start=1&at.fill=%3Cu%3E"))
    assert "<b>error start=1, fill=&lt;u&gt; is exact</b>" in exact
    assert "seen();" in exact
    assert "error: 1.0" in shown(pages.get("/value?run=toy&node=error&at.start=1&at.fill=hold"))


def test_a_value_that_is_not_stored_is_computed_and_stored(opened: Opened) -> None:
    shutil.rmtree("store")
    pages = opened()
    assert 'id="compute"' in shown(pages.get(f"/value?{VALUE}"))
    query = {"run": "toy", "node": "fill", "at.start": "1", "at.fill": "hold"}
    lines = computed(pages.post(json.dumps({"for": "value", "query": query}).encode()))
    assert [line.get("step") for line in lines[1:-1]] == ["a(start=1)", "fill(start=1, fill=hold)"]
    assert lines[-1] == {"finished": True}
    assert "2.0" in shown(opened().get(f"/value?{VALUE}"))


def test_a_block_is_packed_from_what_its_scores_read(opened: Opened) -> None:
    data = opened().get(f"/detail?{urlencode(BLOCK)}").data
    assert data == {
        "block": {"start": 5, "gap": 3},
        "inputs": {"hold": {"estimate": 6.0, "truth": 5.0}},  # the other method refused it
    }


def test_a_block_is_computed_when_it_is_looked_at(opened: Opened) -> None:
    shutil.rmtree("store")
    pages = opened()
    answer = pages.get(f"/detail?{urlencode(BLOCK)}")
    assert (answer.status, answer.data["missing"], answer.data["changed"]) == (202, 2, [])
    lines = computed(pages.post(json.dumps({"for": "detail", "query": BLOCK}).encode()))
    assert lines[-1] == {"finished": True}
    assert pages.get(f"/detail?{urlencode(BLOCK)}").data["inputs"]["hold"]["estimate"] == 6.0


def test_changed_code_is_named_and_used_only_when_asked_for(opened: Opened) -> None:
    edit("toys.py", "x + 1", "x + 10")
    assert "2.0" in shown(opened().get(f"/value?{VALUE}"))  # as it was in the run
    shutil.rmtree("store")
    pages = opened()
    page = shown(pages.get(f"/value?{VALUE}"))
    assert "code: toys was edited" in page
    query = {"run": "toy", "node": "fill", "at.start": "1", "at.fill": "hold"}
    answer = pages.post(json.dumps({"for": "value", "query": query}).encode())
    assert answer.status == 409
    assert "fill.hold: code: toys was edited" in answer.data["message"]
    now = {"for": "value", "query": {**query, "now": "1"}}
    assert computed(pages.post(json.dumps(now).encode()))[-1] == {"finished": True}
    assert "11.0" in shown(pages.get(f"/value?{VALUE}&now=1"))
    assert 'id="compute"' in shown(pages.get(f"/value?{VALUE}"))


def test_no_file_is_imported_because_a_run_names_it(opened: Opened) -> None:
    pages = opened(plugins=())
    assert "<h1" in shown(pages.get("/"))
    assert re.search(r"--plugin \S*toys.py", shown(pages.get(f"/value?{VALUE}")))


def test_what_a_store_does_not_take_is_shown_all_the_same(opened: Opened) -> None:
    shutil.rmtree("store")
    Path("store").write_text("no folder")
    query = {"run": "toy", "node": "fill", "at.start": "1", "at.fill": "hold"}
    pages = opened()
    with pytest.warns(UserWarning, match="store"):
        pages.post(json.dumps({"for": "value", "query": query}).encode())
    assert "2.0" in shown(pages.get(f"/value?{VALUE}"))


def test_nothing_is_computed_for_a_reader_who_has_left(opened: Opened) -> None:
    waiting = """import time, pathlib
    while not pathlib.Path("go").exists():
        time.sleep(0.01)
    return start"""
    edit("toys.py", "return start", waiting)
    pages = opened()
    query = {"run": "toy", "node": "fill", "at.start": "1", "at.fill": "hold", "now": "1"}
    first = pages.post(json.dumps({"for": "value", "query": query}).encode(), leave=True)
    assert first.text.startswith('{"ended": 0')
    Path("go").touch()
    later = {**query, "node": "a"}
    del later["at.fill"]
    computed(pages.post(json.dumps({"for": "value", "query": later}).encode()))
    assert "1.0" in shown(pages.get(f"/value?{urlencode(later)}"))
    assert 'id="compute"' in shown(pages.get(f"/value?{urlencode(query)}"))


def test_a_run_that_stored_nothing_says_so(opened: Opened) -> None:
    graph = ng.load("toy.yaml", plugins=["toys.py"])
    ng.run(graph, cache=False).save("runs/bare")
    page = shown(opened("runs/bare").get(f"/value?{VALUE.replace('run=toy', 'run=bare')}"))
    assert "--no-cache" in page
    assert 'data-now="1"' in page


@pytest.mark.parametrize(
    "body",
    [
        b"", b"[]", b"7", b"{}", b'{"for": "odd", "query": {}}', b'{"for": "value", "query": 7}',
        b"[" * 50_000, b'{"for": "detail", "query": {"node": "table"}}', b"\xff",
        json.dumps({"for": "detail", "query": {**BLOCK, "methods": "7"}}).encode(),
        json.dumps({"for": "detail", "query": {**BLOCK, "block": '{"gap": [7]}'}}).encode(),
    ],
)  # fmt: skip
def test_odd_requests_to_compute_are_messages(opened: Opened, body: bytes) -> None:
    answer = opened().post(body)
    assert answer.status == 409
    assert "internal error" not in answer.data["message"]
    assert "\n" not in answer.data["message"]


def test_a_run_that_goes_on_is_drawn_with_its_states(opened: Opened, folder: Path) -> None:
    shutil.rmtree("store")
    graph = ng.load("toy.yaml", plugins=["toys.py"])
    events: list[Any] = []
    ng.run(graph, store="store", listeners=[events.append])
    going = RunFolder(Path("runs/going"), graph.spec.text)
    half = [event for event in events if event.node in ("", "a") and event.kind != "finished"]
    for event in half:
        going.hear(event)
    pages = opened("runs/going")
    page = shown(pages.get("/"))
    assert 'data-box="fill"' in page
    states = states_in(page)
    assert states["state"] == "running"
    assert {name: each["counts"] for name, each in states["nodes"].items()} == {
        "a": {"done": 2}, "fill": {"waiting": 4}, "error": {"waiting": 4}, "table": {"waiting": 1},
    }  # fmt: skip
    assert '">start=1</a></th><td>done</td>' in shown(pages.get("/values?run=going&node=a"))
    assert '<pre tabindex="0">1.0</pre>' in shown(pages.get("/value?run=going&node=a&at.start=1"))
    assert "2.0" in shown(pages.get(f"/value?{VALUE.replace('run=toy', 'run=going')}"))
    shutil.rmtree("store")
    assert 'id="compute"' in shown(pages.get("/value?run=going&node=a&at.start=1"))
    going.close()  # as if it were killed
    page = shown(pages.get("/"))
    assert "interrupted" in page
    assert "nodegraph run toy.yaml --plugin toys.py --store store --out runs/going" in page
    sent = pages.get("/progress?run=going").text
    assert json.loads(sent.splitlines()[-2].removeprefix("data: "))["going"]["state"] != "running"
    assert "going" in shown(opened("runs").get("/runs"))


@pytest.mark.parametrize("stored", [False, True])
def test_what_an_unfinished_run_has_gathered_is_shown(opened: Opened, stored: bool) -> None:
    edit("toys.py", "    return x\n", "    raise ValueError('no')\n")
    if stored:
        ng.run(ng.load("toy.yaml", plugins=["toys.py"]), store="store")
    graph = ng.load("toy.yaml", plugins=["toys.py"])
    events: list[Any] = []
    ng.run(graph, store="store", listeners=[events.append])
    going = RunFolder(Path("runs/going"), graph.spec.text)
    for event in events[:-1]:
        going.hear(event)
    kinds = {event.kind for event in events}
    assert kinds >= {"refused", "skipped", "failed", "stored" if stored else "done"}
    pages = opened("runs/going")
    page = shown(pages.get("/value?run=going&node=table"))
    assert '<div class="rendered">' in page
    going.close()
    assert re.search("<td>failed</td><td>no .toys.py:", pages.get("/values?node=fill").text)


@pytest.mark.parametrize("name", ["run.json", "study.json.gz", "events.jsonl", "graph.yaml"])
@pytest.mark.parametrize("content", [None, b"", b"\x1f\x8b", b"{}", b"[" * 9999])
def test_a_damaged_folder_is_a_message(opened: Opened, name: str, content: bytes | None) -> None:
    (RUN / name).unlink()
    if content is not None:
        (RUN / name).write_bytes(content)
    pages = opened()
    targets = ["/", "/runs", "/values?run=toy", "/values?run=toy&node=fill"]
    for target in (*targets, f"/value?{VALUE}", "/files/0/run.json"):
        answer = pages.get(target)
        assert answer.status in (200, 404, 409), answer.body
        assert b"internal error" not in answer.body


def test_runs_stand_side_by_side(opened: Opened) -> None:
    shutil.copytree(RUN, "runs/other")
    pages = opened("runs/toy")
    assert 'value="other"' in shown(pages.get("/runs"))
    both = shown(pages.get("/report?run=toy&run=other"))
    assert ">toy<" in both
    assert "./files/1/run.json" in both
    assert shown(opened("runs").get("/")) == shown(opened("runs").get("/runs"))
