"""Texts of an archive mean the same elsewhere, and nothing else in them changes."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import pytest

from nodegraph.archive.relocate import Elsewhere, graph_elsewhere, settings_elsewhere
from nodegraph.runs.settings import RunSettings

HERE = Elsewhere(
    {"/data/old/a.c3d": "inputs/a.c3d"}, {"/data/old", "/data", "/home/anna", "/home/anna/study"}
)


@pytest.mark.parametrize(
    ("text", "meant"),
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
def test_paths_become_what_is_meant_elsewhere(text: str, meant: str) -> None:
    assert HERE.text(text) == meant
    assert HERE.content("a.txt", text.encode()) == meant.encode()
    assert json.loads(HERE.text(json.dumps({"x": text}))) == {"x": meant}


def test_compressed_texts_are_looked_into_and_bytes_left_alone() -> None:
    packed = HERE.content("study.json.gz", gzip.compress(b'"/data/old/a.c3d"'))
    assert gzip.decompress(packed) == b'"inputs/a.c3d"'
    for content in (b"\xff\xfe /data/old/a.c3d", b"\0 /data/old/a.c3d"):
        assert HERE.content("a.bin", content) is content
        assert HERE.still_in(content)
    assert HERE.content("not.gz", b"/data/old/") == b"/data/old/"
    assert not HERE.still_in(b"\xff nothing")


def test_a_graph_leads_to_where_files_lie() -> None:
    text = 'nodes:  # "/x/far.csv" stays\n  a: {path: far.csv, text: "far.csv"}\n  b: near.csv\n'
    moved = {"/x/far.csv": "inputs/it's far.csv", "/x/near.csv": "near.csv"}
    assert graph_elsewhere(text, Path("/x"), "g.yaml", moved) == (
        'nodes:  # "/x/far.csv" stays\n'
        '  a: {path: "inputs/it\'s far.csv", text: "inputs/it\'s far.csv"}\n  b: near.csv\n'
    )
    assert graph_elsewhere("a: near.csv", Path("/x"), "graphs/g.yaml", moved) == ("a: ../near.csv")
    assert graph_elsewhere(text, Path("/elsewhere"), "g.yaml", moved) == text


def test_the_settings_name_what_is_in_the_archive() -> None:
    settings = RunSettings(
        "../g/a.yaml",
        set={"take": "m.csv", "factor": 2},
        axis={"takes": ["m.csv", "n.csv"]},
        only={"x": ["m.csv", "y"]},
        plugins=["p.py"],
        store="/s",
        executor="serial",
    )
    moved = {"m.csv": "inputs/m.csv", "p.py": "plugins/p.py"}
    assert settings_elsewhere(settings, "a.yaml", moved) == RunSettings(
        "a.yaml",
        set={"take": "inputs/m.csv", "factor": 2},
        axis={"takes": ["inputs/m.csv", "n.csv"]},
        only={"x": ["inputs/m.csv", "y"]},
        plugins=["plugins/p.py"],
    )
