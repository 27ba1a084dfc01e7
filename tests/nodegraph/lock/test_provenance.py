"""Names of files that are valid on other machines."""

from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph import NodegraphError
from nodegraph.lock.provenance import refuse_paths, relative


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("study/graphs/a.c3d", "a.c3d"),
        ("study/data/a.c3d", "../data/a.c3d"),
        ("study/graphs/deep/a.c3d", "deep/a.c3d"),
        ("a.c3d", "../../a.c3d"),
    ],
)
def test_a_file_near_the_graph_has_a_relative_path(tmp_path: Path, path: str, name: str) -> None:
    assert relative(tmp_path / path, tmp_path / "study" / "graphs") == name


def test_a_file_of_another_tree_has_only_its_name() -> None:
    root = Path(Path.cwd().anchor)
    assert relative(root / "data" / "a.c3d", root / "studies" / "graphs") == "a.c3d"


def test_a_file_of_another_user_has_only_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Path, "home", lambda: tmp_path / "users" / "one")
    users = tmp_path / "users"
    assert relative(users / "two" / "a.c3d", users / "one" / "graphs") == "a.c3d"
    assert relative(users / "one" / "a.c3d", users / "one" / "graphs") == "../a.c3d"


def test_a_text_must_not_contain_paths_of_a_folder(tmp_path: Path) -> None:
    refuse_paths("nothing\nof that", [tmp_path, Path(tmp_path.anchor)])
    with pytest.raises(NodegraphError, match=r"see .*notes\.txt$"):
        refuse_paths(f"nothing\n  see {tmp_path}/notes.txt\n", [tmp_path])
