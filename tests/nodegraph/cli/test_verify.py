"""``verify`` tells rounding from change, and names what changed, where and by how much."""

from __future__ import annotations

import hashlib
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import pytest

from nodegraph.cli.main import main
from tests.texts import edit

from . import frozen

TAKEN = """\
from nodegraph import node
@node("fill.mean")
def mean(sheet: float) -> float: return sheet
@node("fill.shift")
def shift(sheet: float) -> float: return sheet
@node("toy.cut")
def cut(sheet: float) -> float: return sheet
"""
# beyond the tolerance between any two calls, and too little to turn the order of the means
VARYING = "os.path.getsize('calls.txt') / 1e6"
Verified = Callable[..., tuple[int, str, str]]
STORE = ("--store", "kept", "--executor", "serial")
SHIFTED = "fill(length=2, fill=shift) and 1 more of fill=shift"


@pytest.fixture
def verified(capsys: pytest.CaptureFixture[str]) -> Verified:
    """Write the study and lock it; return a way to verify it."""
    frozen.write_study()
    assert main(["lock", "study.yaml", "--plugin", "study.py", *STORE]) == 0
    capsys.readouterr()

    def call(
        *words: str, plugin: str = "study.py", lock: str = "study.lock"
    ) -> tuple[int, str, str]:
        more = ["--plugin", plugin] if plugin else []
        status = main(["verify", lock, *more, *STORE, *words])
        return status, *capsys.readouterr()

    return call


def lock_again(*words: str) -> None:
    assert main(["lock", "study.yaml", "--plugin", "study.py", *STORE, *words]) == 0


def sign_again(lock: str = "study.lock") -> None:
    """Give an edited lock the checksum of what stands in it now."""
    head, _, rest = Path(lock).read_text().partition("checksum: ")
    body = rest.partition("\n")[2]
    checksum = hashlib.sha256(body.encode()).hexdigest()
    Path(lock).write_text(f"{head}checksum: {checksum}\n{body}")


@pytest.fixture
def drifting(verified: Verified, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], list[str]]:
    """Verify where the sheet is read otherwise though no code changed; give what is printed."""

    def call(size: str) -> list[str]:
        monkeypatch.setenv("DRIFT", size)
        status, out, _ = verified("--rerun")
        assert status == int(out.startswith("diverged"))
        return out.splitlines()

    return call


def test_an_untouched_study_is_identical(verified: Verified) -> None:
    status, out, _ = verified()
    assert status == 0
    assert out == "identical: study.lock: 10 of 10 results identical\n"


def test_stored_results_are_used_unless_it_is_to_run_again(verified: Verified) -> None:
    verified()
    assert Path("calls.txt").read_text() == "read "
    assert verified("--rerun")[1].startswith("identical")
    assert Path("calls.txt").read_text() == "read read "


def test_rounding_is_within_tolerance(drifting: Callable[[str], list[str]]) -> None:
    first, *rest = drifting("1e-12")
    assert first.startswith("within tolerance: study.lock: 1 of 10 results identical, 9 within")
    assert "beyond" not in first
    assert rest == []


def test_a_file_of_drifted_numbers_has_drifted(
    verified: Verified,
    drifting: Callable[[str], list[str]],
    capsys: pytest.CaptureFixture[str],
) -> None:
    edit("study.py", "(sorted(order.means))", "(f'{one!r}' for one in order.means.values())")
    assert verified()[1].startswith("diverged")
    assert main(["lock", "study.yaml", "--plugin", "study.py", *STORE]) == 0
    capsys.readouterr()
    first, *_ = drifting("1e-12")
    assert first.startswith("within tolerance: study.lock: 0 of 10 results identical, 10 within")


def test_a_conclusion_that_rounding_changes_is_in_the_verdict(
    verified: Verified, monkeypatch: pytest.MonkeyPatch
) -> None:
    edit("study.py", '[" < ".join(sorted(one.means, key=one.means.get))]',
                "[f'{one.means[\"mean\"] * 1e12 % 10:.0f}']")  # fmt: skip
    lock_again()
    monkeypatch.setenv("DRIFT", "4e-12")
    status, out, _ = verified("--rerun")
    assert status == 1
    lines = out[out.index("within") :].splitlines()
    assert lines[0].startswith("within tolerance, but conclusions changed: study.lock: 1 of 10")
    assert [line.split(": ")[:2] for line in lines[1:]] == [
        ["order", "no longer"],
        ["order", "now"],
    ]


def test_a_node_that_varies_in_an_audit_is_named(verified: Verified) -> None:
    edit("study.py", "np.loadtxt(path) +", f"np.loadtxt(path) + {VARYING} +")
    assert main(["verify", "study.yaml", "--repeat", "--plugin", "study.py", *STORE]) == 1
    verified()
    lock_again()
    reason = "read.sheet: an audit found that it gives another answer in a second call"
    for words in ((), ("--rerun",)):
        status, out, _ = verified(*words)
        assert status == 0
        assert f"1 result is not stored: {reason}" in out
        first = out.splitlines()[out.splitlines().index("first: sheet") + 1].strip()
        assert first.startswith(
            "code, settings, files and libraries are the same, and an audit found that it gives"
        )


def test_more_than_rounding_that_no_change_explains_keeps_the_conclusions(
    drifting: Callable[[str], list[str]],
) -> None:
    first, *rest = drifting("1e-6")
    assert first.startswith("same conclusions: study.lock: ")
    assert rest[1] == "first: sheet"
    assert "another processor" in rest[2]
    assert rest[-1] == "all conclusions are the same (1)"


def test_what_turns_a_conclusion_has_diverged(drifting: Callable[[str], list[str]]) -> None:
    first, *rest = drifting("100000")
    assert first.startswith("diverged: study.lock: ")
    assert "order: no longer: mean < shift" in rest
    assert "order: now: shift < mean" in rest


def test_an_edited_constant_is_named_with_its_node_and_how_far_results_differ(
    verified: Verified,
) -> None:
    edit("study.py", "SHIFT = 1.0", "SHIFT = 1.5")
    shutil.rmtree("kept")
    status, out, _ = verified()
    lines = out.splitlines()
    assert status == 1
    assert lines[0].startswith("diverged: study.lock: 6 of 10 results identical, 4 beyond")
    assert lines[1].startswith("    the code of ")
    assert lines[3] == f"first: {SHIFTED}"
    assert lines[4] == "    code: study was edited"
    assert lines[5].startswith("    by ")
    assert "times their usual size (root mean square, fill(length=5, fill=shift) most)" in lines[5]
    assert lines[6] == ""
    assert "what follows from that: order (1), picture (1)" in lines
    assert "all conclusions are the same (1)" in lines
    assert any(line.startswith("order: 1 of 2 rows changed; most of all mean of") for line in lines)


def test_how_far_it_is_off_is_about_as_far_as_it_is(verified: Verified) -> None:
    edit("study.py", "1000.0 + SHIFT", "1000.0 + SHIFT + 100.0")
    line = next(line for line in verified()[1].splitlines() if line.startswith("    by "))
    assert 0.03 < float(line.split()[1]) < 0.3  # of numbers that are 1001 each, and some smaller


def test_locked_values_that_are_stored_are_compared_exactly(verified: Verified) -> None:
    edit("study.py", "SHIFT = 1.0", "SHIFT = 1.5")
    lines = verified()[1].splitlines()
    assert lines[3] == f"first: {SHIFTED}"
    assert lines[6] == "    output.cells[0, 0] was 1001.0, now 1001.5 (2 such places)"


def test_another_text_in_a_result_is_no_rounding(verified: Verified) -> None:
    edit("study.py", '"right"', '"wrong"')
    shutil.rmtree("kept")
    assert (
        "    types, shapes, texts or which samples are missing differ" in verified()[1].splitlines()
    )


def test_an_edit_without_effect_is_none(verified: Verified) -> None:
    edit("study.py", "1000.0 + SHIFT", "SHIFT + 1000.0")
    assert verified()[1].startswith("identical: ")


def test_a_file_with_another_content_is_named(verified: Verified) -> None:
    frozen.write_numbers(first=0.75)
    status, out, _ = verified()
    lines = out.splitlines()
    assert status == 1
    assert lines[1] == "    the content of numbers.txt changed"
    assert lines[3:5] == ["first: sheet", "    path: the content of numbers.txt changed"]


def test_a_missing_file_may_be_named_with_set(verified: Verified) -> None:
    Path("there").mkdir()
    shutil.move("numbers.txt", "there/moved.txt")
    status, out, err = verified()
    assert (status, out) == (2, "")
    assert "the graph in study.lock cannot be run" in err
    assert "numbers.txt" in err
    assert "--set file=FILE" in err
    status, out, _ = verified("--set", "file=there/moved.txt")
    assert (status, out) == (0, "identical: study.lock: 10 of 10 results identical\n")


def test_a_file_that_the_command_names_lies_where_the_command_is_given(
    verified: Verified, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "there").mkdir()
    shutil.move("numbers.txt", "there/moved.txt")
    monkeypatch.chdir("there")
    words = {"plugin": "../study.py", "lock": "../study.lock"}
    status, out, _ = verified("--set", "file=moved.txt", **words)
    assert (status, out.split(":")[0]) == (0, "identical")
    monkeypatch.chdir(tmp_path)
    status, _, err = verified("--set", "file=moved.txt")
    assert status == 2
    assert f"moved.txt was looked for in {tmp_path}" in err
    assert "--set file=FILE" in err
    (tmp_path / "moved.txt").mkdir()
    monkeypatch.chdir("there")
    assert verified("--set", "file=moved.txt", **words)[0] == 0


def test_a_word_is_none_of_a_file_of_that_name(verified: Verified) -> None:
    edit("study.yaml", "file: numbers.txt", "file: numbers.txt, word: a")
    edit("study.yaml", "length: $length", "length: $length, word: $word")
    edit("study.py", "length: int = 3", "length: int = 3, word: str")
    edit("study.py", "cells[:length, 0]", "cells[:len(word), 0]")
    lock_again("--set", "word=data")
    Path("data").mkdir()
    status, out, _ = verified("--set", "word=data")
    assert status == 0
    assert "identical: study.lock: 10 of 10" in out


def test_the_locked_text_is_verified_whatever_the_graph_file_says(verified: Verified) -> None:
    edit("study.yaml", "[2, 5]", "[3]")
    status, out, err = verified()
    assert (status, out) == (0, "identical: study.lock: 10 of 10 results identical\n")
    assert "study.yaml was edited" in err
    Path("study.yaml").unlink()
    status, out, err = verified()
    assert (status, out) == (0, "identical: study.lock: 10 of 10 results identical\n")
    assert "study.yaml is missing" in err


def test_the_locked_texts_of_graphs_that_it_uses_are_verified(verified: Verified) -> None:
    Path("inner.yaml").write_text(frozen.INNER)
    Path("outer.yaml").write_text(frozen.OUTER)
    assert main(["lock", "outer.yaml", "--plugin", "study.py", *STORE]) == 0
    edit("inner.yaml", "fill.mean", "fill.shift")
    status, out, err = verified(lock="outer.lock")
    assert status == 0
    assert "identical: outer.lock: 5 of 5 results identical\n" in out
    assert "inner.yaml was edited" in err


def test_a_family_that_has_grown_is_taken_as_it_was(verified: Verified) -> None:
    more = '@node("fill.other")\ndef other(x: float) -> float:\n    return x\n'
    edit("study.py", "@hookimpl\n", f"{more}@hookimpl\n")
    assert verified()[1].splitlines() == [
        "identical: study.lock: 10 of 10 results identical",
        "    the code of 7 of 7 methods differs",
    ]


@pytest.mark.parametrize("alternatives", ["fill.*", "[fill.mean, fill.shift]"])
@pytest.mark.parametrize("words", [(), ("--only", "fill=mean")])
def test_a_plugin_that_claims_a_name_of_the_study_changes_nothing(
    verified: Verified, words: tuple[str, ...], alternatives: str
) -> None:
    edit("study.yaml", "fill.*", alternatives)
    lock_again(*words)
    Path("taken.py").write_text(TAKEN)
    status, out, err = verified("--plugin", "taken.py")
    assert (status, err.count("claimed")) == (0, 0)
    assert "identical: study.lock: " in out


def test_nodes_of_one_name_are_distinguished_as_in_the_lock(verified: Verified) -> None:
    fills = TAKEN.partition('@node("toy')[0].replace("float", "Sheet")
    Path("taken.py").write_text(f"from study import Sheet\n{fills}")
    lock_again("--plugin", "taken.py", "--only", "fill=study:mean")
    Path("third.py").write_text(TAKEN)
    assert verified("--plugin", "taken.py", "--plugin", "third.py")[0] == 0


def test_a_plugin_that_is_absent_is_named(verified: Verified) -> None:
    status, out, err = verified(plugin="")
    assert (status, out) == (2, "")
    assert "study.lock needs what is not installed:" in err
    assert "--plugin study.py: read.sheet" in err


def test_a_node_that_its_plugin_lacks_is_named(verified: Verified) -> None:
    edit("study.py", '"fill.shift"', '"fill.renamed"')
    status, _, err = verified()
    assert status == 2
    assert "plugin study " in err
    assert "no such node: fill.shift" in err


def test_a_refusal_is_a_result(verified: Verified) -> None:
    edit("study.py", "sum() > 8", "sum() > 4")
    status, out, _ = verified()
    lines = out.splitlines()
    assert status == 1
    assert lines[3] == "first: fill(length=5, fill=shift)"
    assert "    was done, now refused: a gap of 5.0 cells" in lines


def test_numbers_in_a_reason_may_drift(
    verified: Verified, drifting: Callable[[str], list[str]]
) -> None:
    edit("study.py", "sum() > 8", "sum() > 4")
    edit("study.py", "a gap of {float(np.isnan(sheet.cells).sum())}", "{np.nanmean(sheet.cells)}")
    lock_again()
    assert any(line.startswith("within tolerance: ") for line in drifting("1e-12"))


def test_a_study_without_conclusions_has_none_to_keep(
    verified: Verified, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("inner.yaml").write_text(frozen.INNER)
    Path("outer.yaml").write_text(frozen.OUTER)
    assert main(["lock", "outer.yaml", "--plugin", "study.py", *STORE]) == 0
    for size, expected in (("1e-12", "within tolerance: "), ("1e-6", "diverged: ")):
        monkeypatch.setenv("DRIFT", size)
        assert expected in verified("--rerun", lock="outer.lock")[1]


def test_a_file_that_has_come_to_an_axis_diverges(verified: Verified) -> None:
    edit("study.yaml", "length: [2, 5]", 'length: [2, 5], one: {files: "numbers*.txt"}')
    edit("study.yaml", "inputs: {file: numbers.txt}\n", "")
    edit("study.yaml", "$file", "$one")
    lock_again()
    frozen.write_numbers("numbers2.txt")
    status, out, _ = verified()
    assert status == 1
    assert "\ndiverged: study.lock: " in out
    assert "    only in this run: sheet(one=numbers2); cut(length=2, one=numbers2); " in out


def test_what_failed_then_and_now_is_counted_as_such(verified: Verified) -> None:
    edit("study.py", "if np.", "if SHIFT: raise ValueError('never')\n    if np.")
    edit("study.yaml", "in: fill}", "in: {from: fill, at: {fill: shift, length: 2}}}")
    assert main(["lock", "study.yaml", "--plugin", "study.py", *STORE]) == 1
    status, out, _ = verified()
    assert status == 0
    ended = "10 of 10 results identical (of these 2 failed and 3 were skipped, as before)"
    assert f"identical: study.lock: {ended}\n" in out


def test_a_picture_drawn_otherwise_is_no_other_result(verified: Verified) -> None:
    edit("study.py", '"grey"', '"blue"')
    status, out, _ = verified()
    assert status == 0
    assert out.splitlines() == [
        "identical: study.lock: 10 of 10 results identical",
        "    the code of 7 of 7 methods differs",
        "    drawn otherwise from the same numbers: picture (1)",
    ]


def test_a_file_with_other_bytes_is_another_result(verified: Verified) -> None:
    edit("study.py", 'ENDING = "!"', 'ENDING = "?"')
    status, out, _ = verified()
    lines = out.splitlines()
    assert status == 1
    assert lines[3:6] == [
        "first: written",
        "    code: study was edited",
        "    the bytes of its files differ",
    ]


def test_a_writer_that_was_edited_is_found_though_what_it_writes_has_drifted(
    verified: Verified, drifting: Callable[[str], list[str]]
) -> None:
    edit("study.py", 'ENDING = "!"', 'ENDING = "?"')
    assert "first: written" in drifting("1e-12")


def test_values_that_cannot_be_stored_are_not_compared(verified: Verified) -> None:
    edit("study.py", "return Drawing(f", "return Other(f")
    edit("study.py", "class Drawing:", "class Other:\n    def __init__(self, text):\n"
                "        self.text = text\n\n\nclass Drawing:")  # fmt: skip
    edit("study.py", "-> Drawing", "-> object")
    assert main(["lock", "study.yaml", "--plugin", "study.py", *STORE]) == 0
    status, out, _ = verified()
    assert status == 0
    assert "cannot be stored, so not compared: picture (1)" in out


def test_a_lock_may_be_verified_from_any_folder(
    verified: Verified, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("inner").mkdir()
    monkeypatch.chdir("inner")
    status, out, _ = verified(plugin="../study.py", lock="../study.lock")
    assert (status, out) == (0, "identical: ../study.lock: 10 of 10 results identical\n")


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("tolerance: 1.0e-09", "tolerance: 1.0e-01", "checksum"),
        ("nodegraph_lock: 2", "nodegraph_lock: 1", "format of the lock is 1, .* `nodegraph lock`"),
        ("# end of the lock", "", "truncated"),
        ("nodegraph_lock", "nodegraph", "not a lock"),
    ],
)
def test_a_lock_that_is_not_as_it_was_written_is_refused(
    verified: Verified, old: str, new: str, reason: str
) -> None:
    edit("study.lock", old, new)
    status, out, err = verified()
    assert (status, out) == (2, "")
    assert re.search(reason, err)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("# end of the lock\n", "# end of the lock\n\n"),
        ("checksum: ", "<<<<<<< ours\nchecksum: 12\n=======\nchecksum: "),
        ("checksum: ", "checksum: 0"),
    ],
)
def test_a_whole_lock_that_was_edited_is_not_cut_off(
    verified: Verified, old: str, new: str
) -> None:
    edit("study.lock", old, new)
    status, out, err = verified()
    assert (status, out) == (2, "")
    assert "study.lock: " in err
    assert "truncated" not in err


def test_a_mark_that_an_editor_sets_before_the_text_changes_nothing(verified: Verified) -> None:
    path = Path("study.lock")
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert verified()[0] == 0
    lock_again()


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("title: A frozen toy\n", "", "title is missing"),
        ("  length: [2, 5]", "  length: 2", "axes.length: "),
        ("versions: {", "versions: {toys: 3, ", "versions.toys: "),
        ("tolerance: 1.0e-09", "tolerance: much", "tolerance: "),
        ("tolerance: 1.0e-09", "tolerance: -1.0", "tolerance: "),
        ("tolerance: 1.0e-09", "tolerance: .inf", "tolerance: "),
        ("conclusions:\n  order: [", "conclusions:\n  order: [3, ", "conclusions.order.0: "),
        ("text:\n", "text: {}\nrest:\n", "text: "),
        ("record: |\n  ", "record: |\n  AAAA", "while decompressing"),
        ("record: |", "record: [1]\nrest: |", "not a valid lock: "),
        ("title: ", "title: [", "not a valid lock: "),
    ],
)
def test_a_lock_of_another_form_is_refused_by_its_key_though_its_checksum_is_right(
    verified: Verified, old: str, new: str, reason: str
) -> None:
    edit("study.lock", old, new)
    sign_again()
    status, out, err = verified()
    assert (status, out) == (2, "")
    assert "study.lock: " in err
    assert reason in err


@pytest.mark.parametrize(
    ("lock", "reason"),
    [
        ("nothing.lock", "no such file"),
        ("study.yaml", "this is not a lock"),
        ("study.zip", "cannot be read as a lock: it is an archive"),
    ],
)
def test_a_file_that_is_not_a_lock_is_an_error(verified: Verified, lock: str, reason: str) -> None:
    with ZipFile("study.zip", "w", ZIP_DEFLATED) as archive:
        archive.writestr("study.lock", "a" * 999)
    status, _, err = verified(lock=lock)
    assert status == 2
    assert f"{lock}: {reason}" in err


def test_a_lock_that_is_not_utf_8_is_refused_with_its_line(verified: Verified) -> None:
    Path("latin.lock").write_bytes(b"a\n\xff")
    status, _, err = verified(lock="latin.lock")
    assert status == 2
    assert "latin.lock:2:1: cannot be read as a lock: not text in UTF-8: byte 0xff" in err
