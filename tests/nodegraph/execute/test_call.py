from __future__ import annotations

import ctypes
import os
import random
import sys
import threading
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from nodegraph import Refusal, Value, node
from nodegraph.execute import shared_state
from nodegraph.execute.call import Call, collecting_warnings, perform
from nodegraph.execute.outcome import Outcome, writes_to_locked_value
from nodegraph.execute.shared_state import unwatch_random
from nodegraph.execute.threads import in_time
from nodegraph.node.decorator import node_of
from nodegraph.node.values import locked
from nodegraph.plugin.registry import Registry


class Two(NamedTuple):
    first: float
    second: str


@dataclass(frozen=True)
class Record:
    first: float
    second: str


@dataclass(frozen=True)
class Whole(Value):
    first: float


@node("call.add")
def add(x: float, *, by: float = 1.0) -> float:
    return x + by


@node("call.two")
def two() -> Two:
    return Two(1.0, "a")


@node("call.record")
def record() -> Record:
    return Record(1.0, "a")


@node("call.whole")
def whole() -> Whole:
    return Whole(1.0)


@node("call.wrong")
def wrong() -> float:
    return "no number"  # type: ignore[return-value]


@node("call.whole_number")
def whole_number() -> float:
    return 1


@node("call.none")
def none() -> float:
    return None  # type: ignore[return-value]


@node("call.wrong_part")
def wrong_part() -> Two:
    return Two(1.0, 2)  # type: ignore[arg-type]


@node("call.not_parts")
def not_parts() -> Two:
    return 5  # type: ignore[return-value]


@node("call.refuses")
def refuses() -> float:
    raise Refusal("needs one complete frame")


@node("call.value_error")
def value_error() -> float:
    raise ValueError("frame 3, marker chin: not finite")


@node("call.key_error")
def key_error() -> float:
    raise KeyError("chin")


@node("call.silent")
def silent() -> float:
    raise RuntimeError


@node("call.full")
def full() -> float:
    raise MemoryError


@node("call.exits")
def exits() -> float:
    raise SystemExit(0)


@node("call.warns")
def warns() -> float:
    for _ in range(2):
        warnings.warn("3 of 9 gaps left open", stacklevel=2)
    warnings.warn("slow", RuntimeWarning, stacklevel=2)
    return 0.0


def raised_in(function: Callable[..., object], line: int = 2) -> str:
    """Return the place of a line of a function, counted from its decorator."""
    return f"test_call.py:{function.__code__.co_firstlineno + line}"


@node("call.writes")
def writes(x: np.ndarray) -> np.ndarray:
    return in_place(x)


def in_place(x: np.ndarray) -> np.ndarray:
    x[0] = 1.0
    return x


@node("call.assigns")
def assigns(x: Whole) -> Whole:
    x.first = 2.0  # type: ignore[misc]
    return x


@node("call.inside")
def inside() -> float:
    return float(np.linalg.inv(np.zeros((2, 3)))[0, 0])


def called(function: Callable[..., object], **inputs: object) -> Outcome:
    described = node_of(function)
    assert described is not None
    return perform(Call(0, described, "toys", inputs, {}))


@pytest.mark.parametrize(
    ("function", "values"),
    [
        (two, (1.0, "a")),
        (record, (1.0, "a")),
        (whole, (Whole(1.0),)),
    ],
)
def test_every_output_is_one_value(
    function: Callable[..., object], values: tuple[object, ...]
) -> None:
    outcome = called(function)
    assert (outcome.state, outcome.values, outcome.reason) == ("done", values, "")


def test_inputs_and_settings_are_given_by_name() -> None:
    described = node_of(add)
    assert described is not None
    assert perform(Call(0, described, "toys", {"x": 1.0}, {"by": 2.0})).values == (3.0,)


@pytest.mark.parametrize(
    ("function", "reason"),
    [
        (wrong, "TypeError: call.wrong returned str where its signature promises float (output)"),
        (
            whole_number,
            "TypeError: call.whole_number returned int where its signature promises float (output)",
        ),
        (
            none,
            "TypeError: call.none returned NoneType where its signature promises float (output)",
        ),
        (
            wrong_part,
            "TypeError: call.wrong_part returned int where its signature promises str (second)",
        ),
        (
            not_parts,
            "TypeError: call.not_parts returned int where its signature promises first, second",
        ),
        (value_error, f"frame 3, marker chin: not finite ({raised_in(value_error)})"),
        (key_error, f"KeyError: 'chin' ({raised_in(key_error)})"),
        (silent, f"RuntimeError: no message ({raised_in(silent)})"),
        (full, f"MemoryError: more memory than it may have ({raised_in(full)})"),
        (exits, f"SystemExit: 0 ({raised_in(exits)})"),
    ],
)
def test_what_goes_wrong_is_the_reason(function: Callable[..., object], reason: str) -> None:
    outcome = called(function)
    assert (outcome.state, outcome.values, outcome.message) == ("failed", (), reason)
    assert outcome.trace.startswith("Traceback")


@pytest.mark.parametrize(
    ("function", "value", "message"),
    [
        (
            writes,
            locked(np.zeros(3)),
            f"assignment destination is read-only ({raised_in(in_place, 1)})",
        ),
        (
            assigns,
            Whole(1.0),
            f"FrozenInstanceError: cannot assign to field 'first' ({raised_in(assigns)})",
        ),
    ],
)
def test_a_write_into_an_input_is_named(
    function: Callable[..., object], value: object, message: str
) -> None:
    advice = "it modifies its input; copy it before writing: "
    assert called(function, x=value).message == f"{advice}{message}"


def test_a_disk_that_cannot_be_written_is_no_input() -> None:
    assert not writes_to_locked_value(OSError("a read-only file system"))
    assert not writes_to_locked_value(Refusal("a read-only take"))


def test_what_a_library_raises_has_the_place_of_the_call() -> None:
    reason = called(inside).message
    assert reason.startswith("Last 2 dimensions")
    assert reason.endswith(f"({raised_in(inside)})")


def test_a_refusal_is_no_failure() -> None:
    outcome = called(refuses)
    assert (outcome.state, outcome.reason) == ("refused", "needs one complete frame")
    assert outcome.trace == ""


def test_a_message_of_any_length_is_one_line() -> None:
    @node("call.loud")
    def loud() -> float:
        warnings.warn("slow\n" * 9000, stacklevel=1)
        raise ValueError("first\n" + "x" * 90_000 + "\nlast")

    with collecting_warnings():
        outcome = called(loud)
    for text in (outcome.reason, *outcome.warnings):
        assert len(text) < 2500
        assert "\n" not in text
    assert outcome.reason.startswith("first x")
    assert "x last" in outcome.reason
    assert outcome.trace.startswith("Traceback")
    assert len(outcome.trace) < 25_000


def test_an_interruption_goes_through() -> None:
    @node("call.interrupted")
    def interrupted() -> float:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        called(interrupted)


def test_warnings_become_part_of_the_outcome() -> None:
    with collecting_warnings():
        outcome = called(warns)
    assert outcome.warnings == ("3 of 9 gaps left open", "slow")


def test_each_call_collects_its_own_warnings() -> None:
    outcomes: dict[int, Outcome] = {}

    def work(number: int) -> None:
        def warn() -> float:
            warnings.warn(f"I am {number}", stacklevel=2)
            return 0.0

        outcomes[number] = called(node("call.warn")(warn))

    with collecting_warnings():
        threads = [threading.Thread(target=work, args=(number,)) for number in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    expected = {number: (f"I am {number}",) for number in range(8)}
    assert {number: outcome.warnings for number, outcome in outcomes.items()} == expected


def foreign(function: Callable[[], float], **more: float) -> Call:
    """Return a call of a node that another package defines."""
    described = node_of(node("call.foreign")(function))
    assert described is not None
    return Call(0, described, "given", {}, {}, "", Registry.of([function]), **more)


def test_a_call_that_begins_in_changed_state_does_not_bring_it_back() -> None:
    path = sys.path.copy()
    changed, begun = threading.Event(), threading.Event()

    def forgets() -> float:
        sys.path.clear()
        changed.set()
        begun.wait()
        return 1.0

    def begins_meanwhile() -> float:
        begun.set()
        first.join()
        return 1.0

    outcomes: list[Outcome] = []
    first = threading.Thread(target=lambda: outcomes.append(perform(foreign(forgets))))
    first.start()
    changed.wait()
    outcomes.append(perform(foreign(begins_meanwhile)))
    now, sys.path[:] = sys.path.copy(), path
    assert now == path
    # threads that other tests have left may change something else meanwhile
    assert ["sys.path" in " ".join(each.warnings) for each in outcomes] == [True, False]


def test_state_that_is_changed_after_a_call_was_given_up_stays(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ended = threading.Event()

    def waits() -> float:
        return float(ended.wait())

    assert in_time(perform, foreign(waits, timeout=0.01)).state == "failed"
    monkeypatch.setenv("CHANGED", "1")
    ended.set()
    assert perform(foreign(waits)).warnings == ()
    assert os.environ["CHANGED"] == "1"


@pytest.mark.parametrize(
    "draw",
    [
        random.random,
        random.gauss,
        lambda: np.random.random(),  # noqa: NPY002
        lambda: np.random.standard_normal(),  # noqa: NPY002
        lambda: np.random.seed(1),  # noqa: NPY002
        lambda: np.random.set_bit_generator(np.random.PCG64(1)),  # type: ignore[attr-defined]
        # as many words as a state has, after which its position is the same
        lambda: random.getrandbits(32 * 624),
        lambda: np.random.bytes(4 * 624),  # noqa: NPY002
    ],
)
@pytest.mark.parametrize("before", [0, 1], ids=["", "the second of a pair"])
def test_every_change_of_global_random_states_is_seen_and_put_back(
    draw: Callable[[], object], before: int
) -> None:
    for _ in range(before):
        random.gauss()
        np.random.standard_normal()  # noqa: NPY002

    def draws() -> float:
        return float(draw() is None)

    def plain() -> float:
        return 1.0

    own, numpy = random.getstate(), repr(np.random.get_state(legacy=False))  # noqa: NPY002
    outcomes = [perform(foreign(draws)) for _ in range(2)]
    now = random.getstate(), repr(np.random.get_state(legacy=False))  # noqa: NPY002
    assert [each.warnings[0].partition(",")[0] for each in outcomes] == [
        "it draws from the global random state"
    ] * 2
    assert now == (own, numpy)
    assert perform(foreign(plain)).warnings == ()


def test_what_threads_of_a_library_draw_is_no_call_s_doing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(shared_state, "_unwatched", set())
    unwatch_random()

    def waits() -> float:
        beside = threading.Thread(target=random.random)
        beside.start()
        beside.join()
        return 1.0

    own = random.getstate()
    outcomes = [perform(foreign(waits)) for _ in range(2)]
    assert [each.warnings for each in outcomes] == [()] * 2
    assert random.getstate() != own


@pytest.mark.parametrize(
    "change",
    [
        lambda folder: Path(folder).rename(f"{folder}_renamed"),
        lambda folder: ctypes.CDLL(None).chdir(b"/"),
    ],
    ids=["renamed", "left in C"],
)
def test_a_working_directory_that_a_call_changes_is_put_back(
    change: Callable[[str], object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)

    def changes() -> float:
        change(str(folder))
        return 1.0

    (warning,) = perform(foreign(changes)).warnings
    assert warning.startswith("it changes the working directory, which is put back")
    assert Path.cwd() == folder


def test_other_warnings_are_shown_as_before() -> None:
    with pytest.warns(UserWarning, match="from the machine"), collecting_warnings():
        warnings.warn("from the machine", stacklevel=1)


class Mute(Exception):
    def __str__(self) -> str:
        raise RuntimeError("no words")


@node("says.nothing")
def mute(x: float) -> float:
    raise Mute


@node("says.unprintable")
def unprintable(x: float) -> float:
    raise ValueError("\udcff")


@node("leaves.early")
def leaves(x: float) -> float:
    raise GeneratorExit("early")


@node("array.made")
def array(x: float) -> np.ndarray:
    return np.ones(3)


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (mute, f"Mute: its message cannot be shown ({raised_in(mute)})"),
        (unprintable, f"\\udcff ({raised_in(unprintable)})"),
        (leaves, f"GeneratorExit: early ({raised_in(leaves)})"),
    ],
)
def test_whatever_a_node_raises_becomes_a_reason(function: object, message: str) -> None:
    described = node_of(function)
    assert described is not None
    outcome = perform(Call(0, described, "toys", {"x": 1.0}, {}))
    assert (outcome.state, outcome.message) == ("failed", message)
    outcome.trace.encode()


def test_what_a_node_made_cannot_be_unlocked() -> None:
    described = node_of(array)
    assert described is not None
    (value,) = perform(Call(0, described, "toys", {"x": 1.0}, {})).values
    with pytest.raises(ValueError, match="WRITEABLE"):
        value.setflags(write=True)
