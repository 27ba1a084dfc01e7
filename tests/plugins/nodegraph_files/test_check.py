"""Before a run, each node of this package that reads a file says whether it can."""

from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph.cli.main import main

UNREADABLE = {
    "empty": ("recording", "take.c3d", b"", "take.c3d: the file is empty"),
    "C3D": ("recording", "take.c3d", b"\2\x50" + bytes(2000), "not a readable C3D recording"),
    "TRC": ("recording", "take.trc", b"PathFileType\t4\n", "the header ends after 1 of 5"),
    "truth": ("truth", "take.csv", b"frame,a.x,a.y,a.z\n1,2,3,4\n", "no rate; set `rate`"),
    "weights": ("weights", "w.csv", b"frame,jawOpen\n1,wide\n", "w.csv:2:2: 'wide' is not"),
    "head": ("head", "head/smile.obj", b"v 0 0 0\n", "no head.glb or neutral.obj or head.obj"),
    "model": ("model", "model.npz", b"PK", "not a readable NPZ model"),
    "marker set": ("marker_set", "set.yaml", b"pairs: []", "a mapping with 'markers'"),
}


@pytest.mark.filterwarnings("ignore:.*no noise-free truth")
@pytest.mark.parametrize(
    ("node", "name", "content", "message"), UNREADABLE.values(), ids=UNREADABLE
)
def test_check_reports_a_file_that_cannot_be_read(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    node: str,
    name: str,
    content: bytes,
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("NODEGRAPH_STORE", str(tmp_path / "store"))
    path = tmp_path / name
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(content)
    named = name.partition("/")[0]
    graph = f"nodegraph: 1\nnodes:\n  it: {{use: read.{node}, with: {{path: {named}}}}}\n"
    (tmp_path / "graph.yaml").write_text(graph)
    assert main(["check", "graph.yaml"]) == 2
    error = capsys.readouterr().err
    assert "graph.yaml:3:" in error
    assert message in error
