"""The page of files shows what viewers make of them, their facts, and what reading them guessed."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from nodegraph.execute.read_files import read_files
from nodegraph.plugin import loading
from nodegraph.plugin.registry import Registry
from nodegraph.serve.files import application_of_files
from nodegraph.serve.guard import Guard
from tests.nodegraph.cli.conftest import READER
from tests.nodegraph.serve.requests import HOST, ORIGIN, Answer, send

VIEWER = """
from nodegraph import Refusal, Rendered, Viewer

def view(values):
    if max(values.values()) > 9:
        raise Refusal("too <many>")
    parts = "+".join(f"{label}={value}" for label, value in values.items())
    return Rendered(f"<b>{parts}</b>", scripts=("one();", "two();"))

@hookimpl
def nodegraph_viewers():
    return [Viewer((int,), view)]
"""


@pytest.fixture(autouse=True)
def _alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(loading, "installed", lambda: ([], []))
    monkeypatch.chdir(tmp_path)
    Path("a").mkdir()
    for name, number in (("a/x", 3), ("x", 4), ("large", 10)):
        Path(f"{name}.count").write_text(f"count:{number}")


def entered(*names: str, plugin: str = READER + VIEWER) -> tuple[Guard, str]:
    """Return what answers for files, and the cookie that it has given."""
    Path("reader.py").write_text(plugin)
    registry = Registry.installed([Path("reader.py")])
    files = read_files(names, registry)
    guard = Guard(application_of_files(files, registry), HOST)
    answer = send(guard, f"/?token={guard.token}")
    return guard, answer.headers["set-cookie"].partition(";")[0]


def page(*names: str, plugin: str = READER + VIEWER) -> str:
    guard, cookie = entered(*names, plugin=plugin)
    assert send(guard, "/").status == 403
    assert send(guard, "/value", cookie=cookie).status == 404
    shown = send(guard, "/", cookie=cookie)
    assert shown.status == 200
    return shown.body.decode()


def test_files_of_one_name_are_shown_together_by_what_the_user_wrote() -> None:
    text = page("a/x.count", "x.count")
    assert "<b>a/x.count=3+x.count=4</b>" in text
    assert (text.count("one();"), text.count("two();")) == (1, 1)
    assert text.count("<dt>number</dt><dd>3 things</dd>") == 1
    assert "a/x.count: it states no unit" in text
    assert "Count, read by read.count" in text


def test_what_a_viewer_refuses_is_told_above_the_facts() -> None:
    text = page("large.count")
    assert "Not drawn: too &lt;many&gt;" in text
    assert "<dd>10 things</dd>" in text


def test_a_file_that_no_viewer_knows_has_its_facts() -> None:
    assert "<dd>4 things</dd>" in page("x.count", plugin=READER)


def test_what_a_page_keeps_of_a_file_lies_beside_it_and_is_read_with_it() -> None:
    plugin = READER + VIEWER.replace("view)]", "view, beside='.more.count')]")
    guard, cookie = entered("a/x.count", "x.count", plugin=plugin)
    file = Path("x.count.more.count")

    def keep(cookie: str = cookie, **data: object) -> Answer:
        body = json.dumps(data).encode()
        return send(
            guard,
            "/kept",
            method="POST",
            body=body,
            cookie=cookie,
            origin=ORIGIN,
            content_type="application/json",
            content_length=str(len(body)),
        )

    assert keep("", label="x.count", text="count:1", before=None).status == 403
    assert keep(label="x.count", text="count:1", before=None).status == 200
    assert file.read_text() == "count:1"
    shown = send(guard, "/", cookie=cookie).text
    assert "<b>a/x.count=3+x.count=4+x.count.more.count=1</b>" in shown
    assert '"x.count": "count:1"' in shown
    refused = keep(label="x.count", text="count:2", before=None)
    assert (refused.status, file.read_text()) == (409, "count:1")
    assert "has changed since the page was loaded" in refused.data["message"]
    assert keep(label="x.count", text="count:no", before="count:1").status == 200
    assert send(guard, "/", cookie=cookie).status == 409
    assert keep().status == 400
    assert keep(label="/etc/passwd", text="", before=None).status == 400
    shutil.rmtree("a")
    gone = keep(label="a/x.count", text="count:1", before=None)
    assert (gone.status, "cannot be written" in gone.data["message"]) == (409, True)
