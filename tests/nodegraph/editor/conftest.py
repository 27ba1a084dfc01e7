"""A graph file that is edited, and the page of it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from nodegraph.editor.app import application
from nodegraph.editor.file import EditedFile
from nodegraph.editor.page import page
from nodegraph.editor.running import Running
from nodegraph.plugin.registry import Registry, default_registry
from nodegraph.serve.guard import Guard
from nodegraph.serve.server import LocalServer
from tests.nodegraph.serve.requests import HOST, ORIGIN, Answer, send

GRAPH = """\
nodegraph: 1
title: Two fills   # of three
axes:
  length: [5, 15]
nodes:
  capture: {use: read.recording, with: {path: "sample:face"}}
  gaps:    {use: gaps.cut, in: capture, with: {length: $length}}
  fill:
    in: gaps.gappy
    alternatives: [fill.linear, fill.muscle]
  error:   {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
report: [error]
"""


class Editor:
    """The requests of the browser that has opened the printed address."""

    def __init__(self, path: Path, registry: Registry, *plugins: Path) -> None:
        self.running = running_of(path, registry, *plugins)
        self._guard = Guard(application(EditedFile(path), registry, self.running), HOST)
        answer = send(self._guard, f"/?token={self._guard.token}")
        self._cookie = answer.headers["set-cookie"].partition(";")[0]

    def get(self, target: str) -> Answer:
        return send(self._guard, target, cookie=self._cookie)

    def view(self) -> Any:
        return self.get("/view").data

    def post(self, body: bytes, target: str = "/edit") -> Answer:
        return send(
            self._guard,
            target,
            method="POST",
            body=body,
            cookie=self._cookie,
            origin=ORIGIN,
            content_type="application/json",
            content_length=str(len(body)),
        )

    def edit(self, status: int = 200, **data: object) -> Any:
        """Edit the present text."""
        answer = self.post(json.dumps({"revision": self.view()["revision"], **data}).encode())
        assert answer.status == status, answer.text
        return answer.data


def running_of(path: Path, registry: Registry, *plugins: Path) -> Running:
    """What runs a file, beside which it writes."""
    folder = path.parent
    return Running(path, folder / "runs" / path.stem, registry, folder / "store", plugins)


@contextmanager
def served_page(path: Path, registry: Registry, *plugins: Path) -> Iterator[str]:
    """Serve the page of a file; yield the address that lets one browser in."""
    running = running_of(path, registry, *plugins)
    file = EditedFile(path)
    server = LocalServer(
        lambda: application(file, registry, running), most_body=1 << 20, page=lambda: page(file)
    )
    answering = Thread(target=server.run)
    answering.start()
    yield server.address
    server.end()
    answering.join()
    running.end()


@pytest.fixture(scope="session")
def registry() -> Registry:
    return default_registry()


@pytest.fixture
def first_text() -> str:
    """The text of the graph file; a module may have another."""
    return GRAPH


@pytest.fixture
def plugins() -> tuple[Path, ...]:
    """Files with further nodes, which the registry has; a module may have some."""
    return ()


@pytest.fixture
def path(tmp_path: Path, first_text: str) -> Path:
    path = tmp_path / "graph.yaml"
    path.write_text(first_text)
    return path


@pytest.fixture
def editor(path: Path, plugins: tuple[Path, ...], registry: Registry) -> Iterator[Editor]:
    editor = Editor(path, registry, *plugins)
    yield editor
    editor.running.end()


@pytest.fixture
def address(path: Path, plugins: tuple[Path, ...], registry: Registry) -> Iterator[str]:
    """The address that lets one browser in, while the page is served."""
    with served_page(path, registry, *plugins) as address:
        yield address
