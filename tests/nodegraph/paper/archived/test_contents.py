"""Texts of an archive mean the same elsewhere, and nothing else in them changes."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import pytest

from nodegraph.paper.archived.inputs import files_read
from nodegraph.paper.archived.texts import Elsewhere, command_elsewhere, graph_elsewhere

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


def test_the_command_names_what_is_in_the_archive() -> None:
    command = (
        "nodegraph run ../g/a.yaml --set take=m.csv --axis 'takes=[m.csv, n.csv]' --only x=m.csv,y "
        "--plugin p.py --store /s --executor serial"
    )
    moved = {"m.csv": "inputs/m.csv", "p.py": "plugins/p.py"}
    assert command_elsewhere(command, "a.yaml", moved) == (
        "nodegraph run a.yaml --set take=inputs/m.csv --axis 'takes=[inputs/m.csv, n.csv]' "
        "--only x=inputs/m.csv,y --plugin plugins/p.py"
    )


def test_files_of_one_name_do_not_meet_and_names_of_the_archive_are_free(tmp_path: Path) -> None:
    import hashlib

    written = ["one/a.txt", "../two/a.txt", "run/a.txt", "a/b.txt"]
    steps = []
    (tmp_path / "g").mkdir()
    for text in written:
        path = tmp_path / "g" / text
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        digest = hashlib.sha256(text.encode()).hexdigest() + ".txt"
        steps.append({"settings": {"path": text}, "files": {"path": digest}})
    steps.append({"settings": {"path": "sample:x"}, "files": {"path": "0"}})
    found = files_read(
        {"steps": steps}, [tmp_path / "g"], {"run"}, lambda one: one.startswith("sample:")
    )
    assert {one.written: one.name for one in found} == {
        "one/a.txt": "one/a.txt",
        "../two/a.txt": "inputs/a.txt",
        "run/a.txt": "inputs/a-2.txt",
        "a/b.txt": "a/b.txt",
        "sample:x": "sample:x",
    }
    assert [one.size for one in found if one.is_shipped] == [0]


def test_a_folder_goes_in_with_all_its_files(tmp_path: Path) -> None:
    from nodegraph.keys import Files

    (tmp_path / "takes" / "deep").mkdir(parents=True)
    (tmp_path / "takes" / "deep" / "a.txt").write_text("a")
    (tmp_path / "takes" / "b.txt").write_text("bb")
    digest = Files().digest(tmp_path / "takes")
    record = {"steps": [{"settings": {"path": "takes"}, "files": {"path": digest}}]}
    [found] = files_read(record, [tmp_path], (), lambda _: False)
    assert [name for name, _ in found.contents()] == ["takes/b.txt", "takes/deep/a.txt"]
    assert found.size == 3
