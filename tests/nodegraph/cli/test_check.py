"""``check`` tells what would run, or every mistake."""

from __future__ import annotations

import os
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import pytest

from nodegraph.plugin import loading
from tests.nodegraph.cli.conftest import NODES, Command
from tests.texts import edit

FIVE_LINES = """\
from nodegraph import node
@node("fill.mine")
def mine(x: float) -> float:
    return x * 100
"""
READER = """
@node("toy.read")
def read(*, file: InputFile) -> float:
    return float(file.read_text())
"""


def test_check_tells_what_would_run(command: Command) -> None:
    status, out, err = command("check", "toy.yaml")
    assert (status, err) == (0, "")
    assert out.splitlines() == [
        "A toy",
        "",
        "node   uses                    along                  steps  stored",
        "a      toy.number                                     1      0",
        "gaps   toy.cut                 length (2)             2      0",
        "fill   fill.hold, fill.strict  length (2) x fill (2)  4      0",
        "total  toy.sum                                        1      0",
        "one    fill.hold                                      1      0",
        "",
        "8 steps, 0 of them stored",
    ]
    command("run", "toy.yaml", "--only", "length=1")
    assert "8 steps, 4 of them stored" in command("check", "toy.yaml")[1]


def test_skipped_combinations_are_counted(command: Command) -> None:
    graph = Path("toy.yaml")
    graph.write_text(f"{graph.read_text()}skip: [{{length: 1, fill: hold}}]\n")
    out = command("check", "toy.yaml")[1]
    assert out.endswith("7 steps, 0 of them stored\n1 combination skipped\n")


def test_modules_without_python_source_are_remembered(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    uses = "def late():\n    import toys_broken, toys_compiled\n    return toys_broken.x\n"
    Path("toys.py").write_text(NODES.replace("return start", "return late()") + uses)
    for name, content in (("broken.py", b"x = ("), ("compiled" + EXTENSION_SUFFIXES[0], b"\0ELF")):
        Path(f"toys_{name}").write_bytes(content)
        os.utime(f"toys_{name}", ns=(1, 1))  # what was written just now is not remembered
    for _ in range(2):
        assert command("check", "toy.yaml")[::2] == (0, "")


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (["pipe"], "pipe: "),
        (["zero.yaml"], "zero.yaml: "),
        (["toy.yaml", "--plugin", "pipe"], "pipe: "),
        (["file.yaml", "--set", "file=pipe"], "--set file: "),
        (["file.yaml"], "file.yaml:3:41: "),
    ],
)
def test_devices_and_pipes_are_refused_at_once(
    command: Command, words: list[str], place: str
) -> None:
    os.mkfifo("pipe")
    reader = "from nodegraph import InputFile\n" + READER
    Path("toys.py").write_text(Path("toys.py").read_text() + reader)
    Path("zero.yaml").symlink_to("/dev/zero")
    Path("file.yaml").write_text(
        "nodegraph: 1\ninputs: {file: zero.yaml}\nnodes: {a: {use: toy.read, with: {file: $file}}}"
    )
    status, _, err = command("check", *words)
    assert status == 2
    assert place in err
    assert "not a regular file" in err


@pytest.mark.parametrize(
    ("text", "place", "hint"),
    [
        ("title: gaps: a study\n", "2:12", "quote a text"),
        ("nodes:\n  a:\n    use: toy.number\n     with: {}\n", "5:10", "indented by 5"),
        ("nodes:\n  a:\n    use: toy.number\n   with: {}\n", "5:4", "indented by 3"),
        ("title: a\n  b\n  c: d\n", "4:4", "continues from the line above"),
        ("title: a\nnodes\n  a:\n    use: toy.number\n", "3:1", "no colon after 'nodes'"),
        ("nodes:\n  a\n    use: toy.number\n", "3:3", "no colon after 'a'"),
        ("nodes:\n  a:\n    use toy.number\n    with: {}\n", "4:5", "no colon after 'use'"),
        ("nodes:\na: {use: toy.number}\n", "3:1", "indent it"),
        ("nodes:\n  a:\n    use:toy.number\n    with: {}\n", "4:9", "no space after"),
        ("nodes: {a: {use:toy.number}}\n", "2:13", "use: toy.number"),
    ],
)
def test_mistakes_in_colons_and_indentation_are_shown_below_the_line(
    command: Command, text: str, place: str, hint: str
) -> None:
    Path("bad.yaml").write_text(f"nodegraph: 1\n{text}")
    _, _, err = command("check", "bad.yaml")
    assert f"bad.yaml:{place}: " in err
    assert hint in err
    line, column = map(int, place.split(":"))
    source = f"nodegraph: 1\n{text}".splitlines()[line - 1]
    assert f"    {line} | {source}\n      | {' ' * (column - 1)}^" in err


REQUIRING = """\
@node("toy.lines")
def lines(*, file: InputFile) -> float:
    return float(len(file.read_text().split()))

@node("toy.slow")
def slow(x: float) -> float:
    raise AssertionError("check called a method")

def fits(x: float, *, length: int) -> None:
    if length > x:
        raise ValueError(f"{length} of {x:g} lines")

@node("toy.part", requires=fits)
def part(x: float, *, length: int, seed: int = 0) -> float:
    fits(x, length=length)
    return length
"""


def test_check_refuses_settings_that_do_not_fit_a_file(command: Command) -> None:
    mark = "from nodegraph import InputFile\n"
    Path("toys.py").write_text(Path("toys.py").read_text() + mark + REQUIRING)
    Path("three").write_text("a b c")
    Path("part.yaml").write_text(
        "nodegraph: 1\naxes: {length: [1, 3, 4], seed: {count: 5}}\nnodes:\n"
        "  a: {use: toy.lines, with: {file: three}}\n"
        "  b: {use: toy.cut, in: a, with: {length: 1}}\n"
        "  c: {use: toy.part, in: a, with: {length: $length, seed: $seed}}\n"
        "  d: {use: toy.part, in: b, with: {length: 5}}\n"
        "  e: {use: toy.slow, in: a}\n"
        "  f: {use: toy.part, in: e, with: {length: 9}}\n"
    )
    status, out, err = command("check", "part.yaml")
    assert (status, out) == (2, "")
    places = [line for line in err.splitlines() if "part.yaml:" in line]
    assert [line.removeprefix("nodegraph: ") for line in places] == [
        "part.yaml:6:44: c(length=4, seed=0): 4 of 3 lines",
        "part.yaml:7:44: d: 5 of 2 lines",
    ]
    os.truncate("three", (16 << 20) + 1)  # too large to be read before a run
    assert command("check", "part.yaml")[0] == 0
    Path("three").write_text("a b c d e f")
    assert command("check", "part.yaml")[0] == 0
    Path("three").write_bytes(b"\xff")
    err = command("check", "part.yaml")[2]
    assert "part.yaml:4:36: a: " in err
    for name in ("three", "tres", "drei"):
        Path(name).write_text("a b c")
    edit = Path("part.yaml").read_text().replace("file: three", "file: $file")
    Path("part.yaml").write_text(edit.replace("axes: {", "axes: {file: [three, tres, drei], "))
    err = command("check", "part.yaml")[2]
    assert "c(file=three, length=4, seed=0) and 2 more of c: 4 of 3 lines" in err
    assert err.count("4 of 3 lines") == 1


COUNTING = """
import warnings

@node("toy.count")
def count(*, file: InputFile) -> float:
    with open("reads", "a") as log:
        log.write(file.name)
    if file.name in "bc":
        warnings.warn("it is old")
    return float(file.read_text())
"""


def test_check_reads_every_small_file_once_and_says_what_readers_say(command: Command) -> None:
    mark = "from nodegraph import InputFile\n"
    toys = Path("toys.py").read_text()
    Path("toys.py").write_text(toys + mark + COUNTING + REQUIRING)
    for name in "abcdefgh":
        Path(name).write_text("3")
    for name in "eh":
        Path(name).write_text("no number")
    Path("many.yaml").write_text(
        "nodegraph: 1\naxes: {file: [a, b, c, d, e, f, g], length: [1, 2]}\nnodes:\n"
        "  first: {use: toy.count, with: {file: $file}}\n"
        "  part: {use: toy.part, in: first, with: {length: $length}}\n"
        "  last: {use: toy.count, with: {file: h}}\n"
        "  again: {use: toy.part, in: last, with: {length: $length}}\n"
        "  kept: {use: toy.slow, in: last}\n"
    )
    status, out, err = command("check", "many.yaml")
    assert (status, out) == (2, "")
    assert sorted(Path("reads").read_text()) == list("abcdefgh")
    assert err.count("could not convert") == 2
    assert "first(file=e): " in err
    assert "many.yaml:6:39: last: " in err

    status, out, err = command("check", "many.yaml", "--only", "file=a,b,c", "--axis", "length=1")
    assert "last: " in err
    Path("h").write_text("5")
    status, out, _ = command("check", "many.yaml", "--only", "file=a,b,c")
    assert status == 0
    assert out.endswith("warning: first(file=b) and 1 more of first: it is old\n")
    os.truncate("h", (16 << 20) + 1)  # it is left to the run
    assert command("check", "many.yaml", "--only", "file=a")[0] == 0


def test_check_takes_choices(command: Command) -> None:
    status, out, _ = command(
        "check", "toy.yaml", "--set", "start=7", "--axis", "length=1,2,3", "--only", "fill=hold"
    )
    assert status == 0
    assert "length (3) x fill (1)" in out
    assert "left out: one: " in out
    status, out, _ = command("check", "toy.yaml", "--axis", "length={count: 2}")
    assert status == 2
    status, out, _ = command("check", "toy.yaml", "--axis", "length={a: 5, b: 6}")
    assert status == 0


def test_all_errors_are_reported(command: Command) -> None:
    edit("toy.yaml", "toy.cut", "toy.cutt")
    edit("toy.yaml", "toy.sum", "toy.sun")
    status, out, err = command("check", "toy.yaml")
    assert (status, out) == (2, "")
    assert "toy.yaml:7:15: no node 'toy.cutt'" in err
    assert "toy.yaml:9:16: no node 'toy.sun'" in err


def test_a_file_of_five_lines_joins_its_family(command: Command) -> None:
    Path("my_fill.py").write_text(FIVE_LINES)
    status, out, _ = command("check", "toy.yaml", "--plugin", "my_fill.py")
    assert status == 0
    assert "fill.hold, fill.mine, fill.strict" in out


def test_a_name_claimed_by_two_plugins_names_both(command: Command) -> None:
    Path("my_hold.py").write_text(FIVE_LINES.replace("fill.mine", "fill.hold"))
    status, _, err = command("check", "toy.yaml", "--plugin", "my_hold.py")
    assert status == 2
    assert "'fill.hold' is claimed by toys:fill.hold and my_hold:fill.hold" in err or (
        "'fill.hold' is claimed by my_hold:fill.hold and toys:fill.hold" in err
    )
    status, out, _ = command("show", "fill", "--plugin", "my_hold.py")
    assert (status, out.count("fill.hold")) == (0, 2)


def test_the_option_for_plugin_files_is_mentioned(command: Command) -> None:
    edit("toy.yaml", "toy.sum", "toy.more")
    status, _, err = command("check", "toy.yaml")
    assert status == 2
    assert "toy.yaml:9:16" in err
    assert "--plugin FILE" in err


def test_a_file_without_nodes_is_a_warning(command: Command) -> None:
    Path("bare.py").write_text("def fill(x):\n    return x\n")
    status, _, err = command("check", "toy.yaml", "--plugin", "bare.py")
    assert status == 0
    assert (
        err == 'warning: bare.py: defines no nodes; write @node("family.method") above a function\n'
    )


def test_an_installed_plugin_that_does_not_import_is_a_warning(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = loading.BrokenPlugin("bad", "bad_module: ImportError: no libfoo")
    monkeypatch.setattr(loading, "installed", lambda: ([], [broken]))
    status, _, err = command("check", "toy.yaml")
    assert status == 0
    assert err == "warning: plugin 'bad' is left out: bad_module: ImportError: no libfoo\n"
