"""An entry that no run has written is damaged, whatever it holds: told, and computed again."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from random import Random

import pytest

from tests.records import read_record, write_steps
from tests.studies import command

from . import forged
from .forged import Change, deep, output

ROOT = Path(__file__).parents[3]
NODES = """\
from dataclasses import dataclass
from typing import NamedTuple
import numpy as np
from nodegraph import Value, node

@dataclass(frozen=True, eq=False)
class Take(Value):
    positions: np.ndarray
    rate: float

    def __post_init__(self) -> None:
        if self.positions.ndim != 1 or not self.rate > 0:
            raise ValueError("no take")
        object.__setattr__(self, "rate", float(self.rate))

class Both(NamedTuple):
    numbers: np.ndarray
    take: Take

@node("toy.both")
def both(*, number: int) -> Both:
    numbers = np.arange(float(number), number + 400)
    return Both(numbers, Take(numbers[:4].copy(), 2.0))

@node("toy.sum")
def total(numbers: np.ndarray, take: Take) -> float:
    return float(numbers.sum() + take.positions.sum() * take.rate)
"""
GRAPH = """\
nodegraph: 1
title: Forged
axes: {{number: {{range: [0, {last}, 1]}}}}
nodes:
  a: {{use: toy.both, with: {{number: $number}}}}
  sum: {{use: toy.sum, in: {{numbers: a.numbers, take: a.take}}}}
"""
ARRAY = '"<f8",[400]'
FIELDS = '["positions","rate"]'
TAKE = f'["value","toys:Take",{FIELDS},["array",0,"<f8",[4]],2.0]'


def field(name: str, value: object) -> Change:
    return lambda data: data.update({name: value})


def blob(*part: object) -> Change:
    """Return a change of where the bytes of the first output lie, its digest included."""
    return output(f'["array",0,{ARRAY}]', list(part))


FORGED: Mapping[str, Change] = {
    "objects": output('["array",0,"|O",[400]]', None),
    "too long": output('["array",0,"<f8",[401]]', None),
    "very many axes": output('["array",0,"<f8",[400' + ",9223372036854775807" * 10**5 + "]]", None),
    "texts without length": output('["array",0,"<U0",[1099511627776]]', b""),
    "strides": output('["array",0,"<f8",[400],[0],[1099511627776]]', None),
    "another buffer": output(f'["array",1,{ARRAY}]', None),
    "no buffer": output(f'["array",0,{ARRAY}]'),
    "a buffer too many": output(f'["array",0,{ARRAY}]', None, b"x"),
    "a buffer in two places": output(f'["tuple",["array",0,{ARRAY}],["array",0,{ARRAY}]]', None),
    "another type": output('"a text"'),
    "no number": output('["number","<f8","0000"]'),
    "a number that is an object": output('["number","|O","0000000000000000"]'),
    "an unknown word": output('["nothing",1]'),
    "a word that is none": output("[[1],1]"),
    "no word": output("[]"),
    "a mapping of JSON": output('{"a":1}'),
    "not a number": output("NaN"),
    "no JSON": output("[[["),
    "very deep": output("[" * 100_000),
    "deep": output(deep(400)),
    "very many lists": output('["list"' + ',["list"]' * 10**5 + "]"),
    "no text": field("outputs", [["\udcff", []], ["1", []]]),
    "another digest": field("digests", ["0" * 64, "0" * 64]),
    "no digest": field("digests", ["x", "y"]),
    "fewer outputs": lambda data: [data[key].pop() for key in ("outputs", "digests", "faithful")],
    "fewer digests": lambda data: data["digests"].pop(),
    "outputs that are none": field("outputs", 5),
    "an output that is none": field("outputs", [5, 5]),
    "no such state": field("state", "odd"),
    "refused with values": field("state", "refused"),
    "reason": field("reason", 5),
    "warnings": field("warnings", [None]),
    "seconds": field("seconds", "x"),
    "not a number of seconds": field("seconds", float("nan")),
    "endless seconds": field("seconds", float("inf")),
    "a number as text": field("created", "1.5"),
    "created": field("created", -1),
    "faithful": field("faithful", []),
    "another key": field("key", "0" * 64),
    "a blob that is not there": blob("0" * 64, 3200),
    "a huge blob": blob("0" * 64, 2**50),
    "a blob elsewhere": blob("../../../victim", 3200),
    "a blob of less than nothing": blob("0" * 64, -1),
    "a blob that is none": blob("x"),
    "bytes that are none": lambda data: data["outputs"].__setitem__(0, ['["bytes",0]', ["%"]]),
    "a field that is not taken": output(TAKE.replace("2.0", "-2.0"), None, at=1),
    "a field of another type": output(TAKE.replace("2.0", "2"), None, at=1),
    "a field too few": output('["value","toys:Take",["rate"],2.0]', at=1),
    "another class": output('["value","nodegraph.node.values:Files",["content"],["dict"]]', at=1),
    "a class that is none": output(f'["value","os:system",{FIELDS},1,2]', at=1),
    "a class that is not text": output(f'["value",5,{FIELDS},1,2]', at=1),
    "a storage that is none": output('["stored","toys:Take",["tuple"]]', at=1),
}  # fmt: skip


def in_process(module: str, *words: str, at: Path) -> subprocess.CompletedProcess[str]:
    """Run a module as a program, which may die of what it reads."""
    path = os.pathsep.join([str(ROOT), str(ROOT / "plugins")])
    return subprocess.run(
        [sys.executable, "-m", module, *words],
        env={**os.environ, "PYTHONPATH": path},
        cwd=at,
        capture_output=True,
        text=True,
        check=False,
    )


def given(*words: str) -> tuple[str, ...]:
    """Return the words of a command with the toy nodes and the store there."""
    nodes = () if words[0] == "cache" else ("--plugin", "toys.py")
    return (*words, "--store", "kept", *nodes)


class Study:
    """A run whose stored results are forged, and what becomes of them."""

    def __init__(self, folder: Path, count: int) -> None:
        self.folder = folder
        (folder / "toys.py").write_text(NODES)
        (folder / "forged.yaml").write_text(GRAPH.format(last=count - 1))
        ended = command(*given("run", "forged.yaml", "--out", "first"), folder=folder)
        assert ended.status == 0, ended.err

    def run(self, out: str) -> str:
        """Run the graph; return what it has told."""
        words = given("run", "forged.yaml", "--out", out)
        ended = in_process("nodegraph.cli.main", *words, at=self.folder)
        assert ended.returncode == 0, ended.stderr
        return "".join(line for line in ended.stderr.splitlines(True) if "stored result" in line)

    def entries(self, node: str) -> dict[str, Path]:
        """Return the entries of a node by their steps."""
        files = {path: forged.payload(path) for path in forged.entry_files(self.folder / "kept")}
        return {data["step"]: path for path, data in files.items() if data["node"] == node}

    def results(self, out: str) -> dict[int, list[str]]:
        """Return of a run by label what the sum's digest is."""
        steps = read_record(self.folder / out)["steps"]
        return {
            step["labels"]["number"]: step["digests"] for step in steps if step["node"] == "sum"
        }


@pytest.fixture(scope="module")
def forgeries(tmp_path_factory: pytest.TempPathFactory) -> tuple[Study, dict[str, Path]]:
    """A run with every forgery in its store, each of the result of another step."""
    study = Study(tmp_path_factory.mktemp("forged"), len(FORGED))
    (study.folder / "victim").write_text("of another program")
    for path in study.entries("toy.sum").values():
        path.unlink()
    entries = study.entries("toy.both")
    paths = {name: entries[f"a(number={at})"] for at, name in enumerate(FORGED)}
    for name, change in FORGED.items():
        forged.forge(paths[name], change)
    shutil.copytree(study.folder / "kept", study.folder / "forged")
    return study, paths


@pytest.fixture(scope="module")
def message(forgeries: tuple[Study, dict[str, Path]]) -> dict[str, str]:
    """What a run tells of each forgery."""
    study, paths = forgeries
    lines = study.run("second").splitlines()
    return {
        name: "".join(line for line in lines if str(path) in line) for name, path in paths.items()
    }


@pytest.mark.parametrize("name", FORGED)
def test_a_forged_entry_is_reported_and_computed_again(
    forgeries: tuple[Study, dict[str, Path]], message: dict[str, str], name: str
) -> None:
    study, paths = forgeries
    assert "computed again" in message[name]
    assert len(message[name]) < 2000
    number = list(FORGED).index(name)
    assert study.results("second")[number] == study.results("first")[number] != []
    assert forged.payload(paths[name])["outputs"][1][0] == TAKE


@pytest.mark.usefixtures("message")
def test_no_other_file_is_taken_for_a_part_of_the_store(
    forgeries: tuple[Study, dict[str, Path]],
) -> None:
    assert (forgeries[0].folder / "victim").read_text() == "of another program"


@pytest.mark.parametrize(
    ("words", "status", "text"),
    [
        (("cache",), 0, "results"),
        (("cache", "list"), 0, "toy.both"),
        (("cache", "prune", "--keep", "1GB"), 0, "removed"),
        (("check", "forged.yaml"), 0, "computed again"),
        (("check", "forged.yaml", "--why", "a", "--run", "first"), 0, "computed again"),
        (("lock", "forged.yaml"), 0, "computed again"),
        (("diff", "first", "other"), 1, "no longer stored"),
        (("export", "first", "a", "--at", "number=0", "--out", "a.csv"), 2, "not in the store"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_every_command_reads_forged_entries(
    forgeries: tuple[Study, dict[str, Path]], words: tuple[str, ...], status: int, text: str
) -> None:
    folder = forgeries[0].folder
    for name, source in (("kept", "forged"), ("other", "first")):
        shutil.rmtree(folder / name, ignore_errors=True)
        shutil.copytree(folder / source, folder / name)
    steps = read_record(folder / "first")["steps"]
    result = [step for step in steps if step["node"] == "a"]
    results = [(step["key"], step["digests"]) for step in result]
    for step, (key, digests) in zip(result, results[1:] + results[:1], strict=True):
        step |= {"key": key, "digests": digests}
    write_steps(folder / "other", steps)
    ended = command(*given(*words), folder=folder)
    assert ended.status == status, ended.err
    assert text in ended.out + ended.err
    assert "mistake of the program" not in ended.err


def test_what_is_changed_by_chance_is_never_kept_as_a_result(tmp_path: Path) -> None:
    study, chance = Study(tmp_path, 120), Random(7)
    for path in study.entries("toy.sum").values():
        path.unlink()
    for path in study.entries("toy.both").values():
        if chance.random() < 0.5:
            forged.any_bytes(path, chance)
        else:
            forged.forge(path, forged.any_change(chance))
    lines = study.run("second").splitlines()
    assert 50 < len(lines) < 120
    assert study.results("second") == study.results("first")


@pytest.mark.skipif(sys.platform != "linux", reason="the program limits its memory as Linux does")
def test_no_forgery_crashes_or_takes_much_memory(tmp_path: Path) -> None:
    ended = in_process("tests.nodegraph.store.fuzz", str(tmp_path), "11", "500", at=ROOT)
    assert ended.returncode == 0, ended.stderr
    result = json.loads(ended.stdout)
    assert sum(result["counts"].values()) == 520
    assert result["counts"]["output: damaged"] > result["counts"]["output: another value"] > 0
    assert result["counts"]["anything: the same value"] > 0
    assert result["megabytes"] < 200
