"""Paths of this machine in texts are replaced, and nothing else."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import pytest

from nodegraph.archive import relocate
from nodegraph.archive.relocate import Relocation, relocate_graph, relocate_settings
from nodegraph.execute.settings import RunSettings

RELOCATION = Relocation(
    {"/data/old/a.c3d": "inputs/a.c3d"}, {"/data/old", "/data", "/home/anna", "/home/anna/study"}
)


@pytest.mark.parametrize(
    ("text", "relocated"),
    [
        ("/data/old/a.c3d: frame 3", "inputs/a.c3d: frame 3"),
        ("'/data/old/a.c3d'", "'inputs/a.c3d'"),
        ("/data/old/a.c3d2", "a.c3d2"),
        ("file:///data/old/b.c3d", "file://b.c3d"),
        ("path=/data/x/y.csv", "path=x/y.csv"),
        ("/home/anna/study/toys.py", "toys.py"),
        ("kept in /home/anna", "kept in ~"),
        ("kept in /data/old.", "kept in old."),
        ("http://example.org/data/old/", "http://example.org/data/old/"),
        ("mm/data/frame", "mm/data/frame"),
        ("base64,AAA/data/BBB+/data/CCC", "base64,AAA/data/BBB+/data/CCC"),
        ("/database", "/database"),
        ("nothing", "nothing"),
    ],
)
def test_paths_of_this_machine_are_replaced(text: str, relocated: str) -> None:
    assert RELOCATION.text(text) == relocated
    assert RELOCATION.content("a.txt", text.encode()) == relocated.encode()
    assert json.loads(RELOCATION.text(json.dumps({"x": text}))) == {"x": relocated}


def test_compressed_texts_are_relocated_and_binary_files_are_not() -> None:
    packed = RELOCATION.content("study.json.gz", gzip.compress(b'"/data/old/a.c3d"'))
    assert gzip.decompress(packed) == b'"inputs/a.c3d"'
    for content in (b"\xff\xfe /data/old/a.c3d", b"\0 /data/old/a.c3d"):
        assert RELOCATION.content("a.bin", content) is content
        assert RELOCATION.matches(content)
    assert RELOCATION.content("not.gz", b"/data/old/") == b"/data/old/"


def test_a_text_that_is_compressed_beyond_a_bound_stays_as_it_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(relocate, "_MOST_BYTES", 1000)
    for count in (990, 1001):
        packed = gzip.compress(b"/data/old/".ljust(count))
        assert (RELOCATION.content("a.txt.gz", packed) is packed) == (count > 1000)
    assert not RELOCATION.matches(b"\xff nothing")


def test_a_graph_has_the_paths_of_the_archive() -> None:
    text = 'nodes:  # "/x/far.csv" stays\n  a: {path: far.csv, text: "far.csv"}\n  b: near.csv\n'
    names = {"/x/far.csv": "inputs/it's far.csv", "/x/near.csv": "near.csv"}
    assert relocate_graph(text, Path("/x"), "g.yaml", names) == (
        'nodes:  # "/x/far.csv" stays\n'
        '  a: {path: "inputs/it\'s far.csv", text: "inputs/it\'s far.csv"}\n  b: near.csv\n'
    )
    assert relocate_graph("a: near.csv", Path("/x"), "graphs/g.yaml", names) == ("a: ../near.csv")
    assert relocate_graph(text, Path("/elsewhere"), "g.yaml", names) == text


def test_settings_have_the_paths_of_the_archive() -> None:
    settings = RunSettings(
        "../g/a.yaml",
        set={"take": "m.csv", "factor": 2},
        axis={"takes": ["m.csv", "n.csv"]},
        only={"x": ["m.csv", "y"]},
        plugins=["p.py"],
        store="/s",
        executor="serial",
    )
    names = {"m.csv": "inputs/m.csv", "p.py": "plugins/p.py"}
    assert relocate_settings(settings, "a.yaml", names) == RunSettings(
        "a.yaml",
        set={"take": "inputs/m.csv", "factor": 2},
        axis={"takes": ["inputs/m.csv", "n.csv"]},
        only={"x": ["inputs/m.csv", "y"]},
        plugins=["plugins/p.py"],
    )
