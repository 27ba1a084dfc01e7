"""The command keeps what is not saved, whatever ends it."""

from __future__ import annotations

import json
import signal
from http.client import HTTPConnection
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests.nodegraph.serve.test_server import served

TEXT = "nodegraph: 1\nnodes:\n  take: {use: read.recording}\n"


def test_what_is_not_saved_is_there_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "new.yaml"
    edit = {"text": TEXT}
    for end in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        with served("edit", "new.yaml", "--no-browser") as (address, process):
            assert ask(address, edit) == TEXT
            process.send_signal(end)
            _, errors = process.communicate()
        assert (path.exists(), Path("new.yaml.unsaved").read_text()) == (False, TEXT)
        assert "Traceback" not in errors
        if end is signal.SIGINT:
            assert process.returncode == 130
            assert "not saved; kept in" in errors
        edit = {}
    with served("edit", "new.yaml", "--no-browser") as (address, process):
        assert ask(address, {"action": "save"}) == TEXT
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
    assert "not saved" not in errors
    assert [each.name for each in tmp_path.iterdir()] == ["new.yaml"]
    assert path.read_text() == TEXT


def ask(address: str, edit: dict[str, str]) -> str:
    """Edit the text as the page does, if there is an edit; return what it is then."""
    place = urlsplit(address)
    connection = HTTPConnection(place.netloc, timeout=60)
    connection.request("GET", f"/?{place.query}")
    answer = connection.getresponse()
    answer.read()
    headers = {
        "Cookie": str(answer.headers["Set-Cookie"]).partition(";")[0],
        "Origin": f"http://{place.netloc}",
        "Content-Type": "application/json",
    }
    connection.request("GET", "/view", headers=headers)
    view = json.loads(connection.getresponse().read())
    if edit:
        data = json.dumps({"revision": view["revision"], **edit})
        connection.request("POST", "/edit", data, headers)
        view = json.loads(connection.getresponse().read())
    connection.close()
    return str(view["text"])
