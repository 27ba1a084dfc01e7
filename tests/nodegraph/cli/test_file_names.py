"""Every file of a run has a name of its own that any disk can have, whatever labels there are."""

from __future__ import annotations

import html
import json
import re
import zipfile
from collections.abc import Iterable
from pathlib import Path
from urllib.parse import unquote

import pytest

from tests.nodegraph.cli.conftest import Command
from tests.nodegraph.cli.portable import check_portable, paths_in
from tests.records import read_record

NODES = """
from nodegraph import Files, Rendered, Kind, hookimpl

class Word(str):
    '''A text that has a file beside the report.'''

@node("toy.word")
def word(*, x: str | int | float = "", y: str | float = "", z: str | float = "") -> Word:
    return Word("|".join(str(text) for text in (x, y, z) if text != ""))

class Both(NamedTuple):
    Word: Word
    word: Word

@node("toy.both")
def both(*, x: str = "") -> Both:
    return Both(Word(f"upper {x}"), Word(f"lower {x}"))

@node("write.files")
def files(*, names: list[str]) -> Files:
    return Files({name: name.encode() for name in names})

@hookimpl
def nodegraph_kinds():
    def render(value, title):
        suffixes = (".csv", ".html", ".json", ".yaml", ".json.gz", ".jsonl")
        return Rendered("", value, {suffix: value.encode() for suffix in suffixes})
    return [Kind(Word, render)]
"""
JAPANESE = "\N{CJK UNIFIED IDEOGRAPH-6F22}" * 78
COMPOSED, DECOMPOSED = "caf\u00e9", "cafe\u0301"


@pytest.fixture(autouse=True)
def _nodes() -> None:
    """Words with files beside the report, and a node that names files itself."""
    path = Path("toys.py")
    path.write_text(path.read_text() + NODES)


def graph(nodes: str, **axes: Iterable[object]) -> None:
    lists = json.dumps({name: list(labels) for name, labels in axes.items()}, ensure_ascii=False)
    Path("toy.yaml").write_text(f"nodegraph: 1\naxes: {lists}\nnodes:\n{nodes}\n")


def links(folder: Path) -> list[str]:
    """Return the paths to which the results of a report link, in their order."""
    # all files are listed once more below
    results = (folder / "report.html").read_text().partition('id="download"')[0]
    targets = re.findall(r'href="\./([^"]+)">', results)
    paths = [unquote(html.unescape(target)) for target in targets]
    return [path for path in paths if path not in ("run.json", "steps.jsonl.gz", "events.jsonl")]


def texts(folder: Path, suffix: str = ".csv") -> list[str]:
    """Return what the linked files of a suffix hold, in the order of the report."""
    return [(folder / path).read_text() for path in links(folder) if path.endswith(suffix)]


def test_each_label_has_its_own_files_to_which_its_section_links(command: Command) -> None:
    labels = [
        "<5", ">5", "a/b", "a b", "a-b", "a_b", "a\\b", "A", "a", "Mb", "MB", "mB", COMPOSED,
        DECOMPOSED, COMPOSED.upper(), JAPANESE, f"{JAPANESE}!", JAPANESE[1:], 1, "1", "01", -1, 1.5,
        "1.5", "CON", "nul", "..", ".", " ", "x.", "x ", "-x", ".x", "\t", "a:b", "a*", "a?", 'a"',
        "a|", "\N{LATIN SMALL LETTER SHARP S}", "ss", "\N{SUPERSCRIPT TWO}", "2",
        "\N{GRINNING FACE}",
    ]  # fmt: skip
    graph("  t: {use: toy.word, with: {x: $x}}", x=labels)
    assert command("run", "toy.yaml")[0] == 0
    folder = Path("runs/toy")
    check_portable(paths_in(folder))
    assert texts(folder) == [str(label) for label in labels]


def test_names_of_nodes_and_outputs_meet_neither_each_other_nor_the_files_of_the_run(
    command: Command,
) -> None:
    names = ("T", "t", "con", "_", "_x", "x", "report", "run", "graph", "events", "study", "tt")
    nodes = [f"  {name}: {{use: toy.word, with: {{x: {name}}}}}" for name in names]
    graph(
        "\n".join([*nodes, "  Both: {use: toy.both}", "  w: {use: write.files, with: {names: []}}"])
    )
    assert command("run", "toy.yaml")[0] == 0
    folder = Path("runs/toy")
    check_portable(paths_in(folder))
    assert texts(folder) == [*names, "upper ", "lower "]
    for suffix in (".html", ".json", ".yaml", ".jsonl"):
        assert texts(folder, suffix) == [*names, "upper ", "lower "]
    assert "<h1>" in (folder / "report.html").read_text()
    assert json.loads((folder / "run.json").read_text())["format"] == 2
    assert (folder / "graph.yaml").read_text() == Path("toy.yaml").read_text()


def test_a_result_that_is_listed_twice_has_its_files_once(command: Command) -> None:
    graph("  a: {use: toy.both}\nreport: [a, a.word]")
    assert command("run", "toy.yaml")[0] == 0
    assert texts(Path("runs/toy")) == ["upper ", "lower ", "lower "]
    assert len(list(Path("runs/toy").glob("*.csv"))) == 2


def test_files_that_a_node_names_are_all_there(command: Command) -> None:
    names = [
        "x.txt", "X.txt", "deep/x.txt", "Deep/x.txt", "a", "a/b", "CON.txt", "aux", "why?.txt",
        "<5", ">5", "trail.", "trail ", ".hidden", "-dash", f"{'n' * 300}.csv", f"{'m/' * 150}n",
        f"{JAPANESE}.csv", COMPOSED, DECOMPOSED, "take 1 (best).c3d", "?/" * 50 + "x", "?/x",
    ]  # fmt: skip
    graph(f"  w: {{use: write.files, with: {{names: {json.dumps(names)}}}}}")
    assert command("run", "toy.yaml")[0] == 0
    folder = Path("runs/toy")
    check_portable(paths_in(folder))
    assert [(folder / path).read_text() for path in links(folder)] == names
    for name in ("x.txt", "deep/x.txt", "a", COMPOSED, "take 1 (best).c3d"):
        assert (folder / "w" / name).read_text() == name


@pytest.mark.parametrize("name", ["../x", "/x", "a/../../x", "C:x", "a\\b", "a\nb", ""])
def test_a_file_that_would_lie_elsewhere_fails_its_step_alone(command: Command, name: str) -> None:
    names = json.dumps(["x.txt", name])
    graph(f"  w: {{use: write.files, with: {{names: {names}}}}}\n  t: {{use: toy.word}}")
    assert command("run", "toy.yaml")[0] == 1
    steps = {step["node"]: step for step in read_record("runs/toy")["steps"]}
    assert (steps["w"]["state"], steps["t"]["state"]) == ("failed", "done")
    assert repr(name) in steps["w"]["reason"]
    assert steps["w"]["place"].startswith("toys.py:")
    assert "w" not in {path.name for path in Path("runs/toy").iterdir()}
    assert not Path("x").exists()


@pytest.mark.parametrize(
    "name", ["n" * 250, "g" + "\N{CJK UNIFIED IDEOGRAPH-6F22}" * 83, "a?", "NUL"]
)
def test_a_graph_file_may_have_any_name(command: Command, name: str) -> None:
    Path(f"{name}.yaml").write_text(Path("toy.yaml").read_text())
    for start in ("start=1", "start=2", "start=5"):
        assert command("run", f"{name}.yaml", "--set", start)[0] == 0
    folders = [path.name for path in Path("runs").iterdir()]
    assert len(folders) == 3
    check_portable(folders)
    assert command("check", f"{name}.yaml", "--why", "fill")[0] == 0
    assert command("lock", f"{name}.yaml")[0] == 0
    assert command("verify", f"{name}.lock")[0] == 0
    assert command("run", "toy.yaml", "--out", name)[0] == 0
    assert command("run", "toy.yaml", "--out", name, "--set", "start=2")[0] == 0
    assert command("archive", name, nodes=False)[0] == 0
    assert [zipfile.is_zipfile(path) for path in Path().glob("*.zip")] == [True]


def test_a_graph_that_uses_one_called_as_its_own_copy_is_kept(command: Command) -> None:
    inner = "nodegraph: 1\nnodes: {a: {use: toy.word}}\noutputs: {x: a}\n"
    outer = "nodegraph: 1\nnodes: {inside: {use: ./graph.yaml}}\n"
    Path("graph.yaml").write_text(inner)
    Path("toy.yaml").write_text(outer)
    assert command("run", "toy.yaml")[0] == 0
    folder = Path("runs/toy")
    assert (folder / "graph.yaml").read_text() == inner
    [copy] = [path for path in folder.glob("*.yaml") if path.read_text() == outer]
    check_portable(paths_in(folder))
    assert command("run", str(copy), "--out", "again")[0] == 0


def test_members_of_an_archive_do_not_meet(command: Command) -> None:
    for folder in ("one", "two", "Two"):
        Path(folder).mkdir()
        text = f"nodegraph: 1\nnodes: {{a: {{use: toy.word, with: {{x: {folder}}}}}}}\n"
        Path(folder, "part.yaml").write_text(text + "outputs: {x: a}\n")
    Path("main").mkdir()
    uses = ", ".join(f"{name}: {{use: ../{name}/part.yaml}}" for name in ("one", "two", "Two"))
    Path("main/toy.yaml").write_text(f"nodegraph: 1\nnodes: {{{uses}}}\n")
    assert command("run", "main/toy.yaml", "--out", "ran")[0] == 0
    assert command("archive", "ran", nodes=False)[0] == 0
    with zipfile.ZipFile("ran.zip") as file:
        check_portable(file.namelist())
        file.extractall("there")
    assert command("run", "there/toy.yaml", "--out", "again")[0] == 0
    assert sorted(texts(Path("again"))) == ["Two", "one", "two"]


def test_an_export_of_several_files_overwrites_none_of_them(command: Command) -> None:
    names = json.dumps(["x.txt", "OUT.txt", "out.txt", "why?.txt", "other.csv"])
    graph(f"  w: {{use: write.files, with: {{names: {names}}}}}")
    assert command("run", "toy.yaml", "--store", "kept")[0] == 0
    words = ["export", "runs/toy", "w", "--store", "kept", "--out", "there/out.txt"]
    assert command(*words)[0] == 0
    check_portable(paths_in(Path("there")))
    held = [path.read_text() for path in Path("there").iterdir()]
    assert sorted(held) == ["OUT.txt", "out.txt", "why?.txt", "x.txt"]
    assert Path("there/out.txt").read_text() == "x.txt"


def test_an_export_that_would_overwrite_a_file_writes_none(command: Command) -> None:
    graph("  w: {use: write.files, with: {names: [x.txt, y.txt]}}")
    assert command("run", "toy.yaml", "--store", "kept")[0] == 0
    Path("there").mkdir()
    Path("there/y.txt").write_text("mine")
    words = ["export", "runs/toy", "w", "--store", "kept", "--out", "there/out.txt"]
    status, _, err = command(*words)
    assert (status, "there/y.txt" in err) == (2, True)
    assert paths_in(Path("there")) == ["y.txt"]
