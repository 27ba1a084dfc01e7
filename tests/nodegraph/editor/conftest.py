"""A graph file that is edited, and the page of it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from threading import Thread

import pytest

from nodegraph.editor.app import application
from nodegraph.editor.file import EditedFile
from nodegraph.plugin.registry import Registry, default_registry
from nodegraph.serve.server import LocalServer

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


@pytest.fixture(scope="session")
def registry() -> Registry:
    return default_registry()


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "graph.yaml"
    path.write_text(GRAPH)
    return path


@pytest.fixture
def address(path: Path, registry: Registry) -> Iterator[str]:
    """The address that lets one browser in, while the page is served."""
    server = LocalServer(application(EditedFile(path), registry), most_body=1 << 20)
    answering = Thread(target=server.run)
    answering.start()
    yield server.address
    server.end()
    answering.join()
