"""What goes in comes out, to the bit and of the same type, or is refused."""

from __future__ import annotations

import struct
import sys
import types
from collections import OrderedDict
from dataclasses import InitVar, dataclass
from enum import IntEnum
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph import Absent, Across, Kind, Value
from nodegraph.store import Packed, Packer, Unreadable, Unstorable
from tests.texts import any_text


@dataclass(frozen=True, eq=False)
class Take(Value):
    positions: Any
    name: str = ""
    inner: Any = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", f"{self.name}!")

    @cached_property
    def size(self) -> int:
        return int(self.positions.size)


@dataclass(frozen=True, slots=True)
class Slotted(Value):
    first: object
    second: int = 2


@dataclass
class Loose(Value):
    first: int


@dataclass(frozen=True)
class Checked(Value):
    rate: float
    marks: tuple[int, ...] = ()
    numbers: object = None

    def __post_init__(self) -> None:
        if not self.rate > 0:
            raise ValueError("rate must be positive")
        object.__setattr__(self, "rate", float(self.rate))
        object.__setattr__(self, "marks", tuple(self.marks))
        if self.numbers is not None:
            object.__setattr__(self, "numbers", np.asarray(self.numbers, float))


@dataclass(frozen=True)
class Leaving(Value):
    first: int

    def __post_init__(self) -> None:
        if self.first > 1:
            sys.exit("too much")


@dataclass(frozen=True)
class Scaled(Value):
    first: float
    scale: InitVar[float]

    def __post_init__(self, scale: float) -> None:
        object.__setattr__(self, "first", self.first * scale)


class NoDataclass(Value):
    pass


class Colour(IntEnum):
    RED = 1


class Pair(NamedTuple):
    first: int


class Text(str):
    pass


class Thing:
    """Something that only a plugin can keep."""

    def __init__(self, *parts: Any) -> None:
        self.parts = list(parts)


class SmallThing(Thing):
    pass


def things(**more: Any) -> Packer:
    return Packer(
        [
            Kind(
                Thing,
                take_apart=lambda thing: thing.parts,
                put_together=lambda parts: Thing(*parts),
                **more,
            )
        ]
    )


def there_and_back(value: object, packer: Packer | None = None) -> Any:
    packer = packer or Packer()
    packed = packer.pack(value)
    assert packed.head.isascii()
    return packer.unpack(packed.head, [bytes(buffer) for buffer in packed.buffers])


def alike(first: Any, other: Any) -> bool:
    """Whether two plain values are the same, to the type and to the bit."""
    if type(first) is not type(other):
        return False
    if isinstance(first, float):
        return struct.pack("<d", first) == struct.pack("<d", other)
    if isinstance(first, (list, tuple)):
        return len(first) == len(other) and all(map(alike, first, other))
    if isinstance(first, dict):
        return alike(list(first), list(other)) and alike(list(first.values()), list(other.values()))
    return bool(first == other)


LEAVES = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(st.characters(exclude_categories=()))
    | st.binary()
    | st.builds(Path, st.text("abc/.é", max_size=8))
)
KEYS = st.booleans() | st.integers() | any_text(max_size=3) | st.tuples(st.integers(), any_text())
PLAIN = st.recursive(
    LEAVES,
    lambda inner: (
        st.lists(inner) | st.lists(inner).map(tuple) | st.dictionaries(KEYS, inner, max_size=4)
    ),
    max_leaves=12,
)


@given(PLAIN)
def test_plain_values_come_back_as_they_were(value: object) -> None:
    assert alike(value, there_and_back(value))


@pytest.mark.parametrize(
    "value",
    [
        -0.0,
        float("inf"),
        float("nan"),
        2**63,
        -(2**63),
        16**6000,
        "😀\ud83d",
        {(1, "x"): None, 1.5: b"", None: ()},
        {True: 1, 2: "b", "a": {}},
        [],
        (),
        ["list", 1],
        Path(),
        (b"\0" * 5000, b""),
    ],
    ids=lambda value: ascii(value)[:20] if not isinstance(value, int) else "whole",
)
def test_odd_values_come_back_as_they_were(value: object) -> None:
    assert alike(value, there_and_back(value))


def test_the_order_of_a_mapping_is_kept() -> None:
    assert list(there_and_back({"b": 1, "a": 2, "": 3})) == ["b", "a", ""]


def test_what_was_gathered_comes_back() -> None:
    gathered = Across(
        ("fill", "trial"),
        (({"fill": "linear", "trial": 3}, 1.5), ({"fill": "", "trial": True}, 2.5)),
        (Absent({"fill": "muscle", "trial": 4}, "refused", "no complete frame"),),
        sources=("trial",),
        methods={"fill": {"linear": {"lookahead": None, "ends": True}}},
        fields={"trial.actor": {3: "anna", True: "ben"}},
    )
    assert there_and_back(gathered) == gathered
    assert there_and_back(Absent({"a": 1}, "failed", "x")) == Absent({"a": 1}, "failed", "x")


@pytest.mark.parametrize(
    ("written", "forged"),
    [
        ('["tuple","fill"]', '["tuple",5]'),
        ('["dict","fill","linear"]', '["list","fill","linear"]'),
        ('["absent",["dict","fill","muscle"],"refused","why"]', '"muscle"'),
        ('["dict","fill","muscle"],"refused"', '["dict","fill","muscle"],5'),
    ],
)
def test_what_was_gathered_is_checked_part_by_part(written: str, forged: str) -> None:
    absent = Absent({"fill": "muscle"}, "refused", "why")
    packed = Packer().pack(Across(("fill",), (({"fill": "linear"}, 1.5),), (absent,)))
    assert written in packed.head
    with pytest.raises(Unreadable):
        Packer().unpack(packed.head.replace(written, forged))


@pytest.mark.parametrize(
    "value",
    [Colour.RED, Pair(1), Text("a"), OrderedDict(a=1), {1, 2}, frozenset(), 1j, bytearray(b"a"),
     range(3), object(), Thing(), len, int, slice(1), np.dtype("f8"), types.MappingProxyType({})],
    ids=lambda value: type(value).__name__,
)  # fmt: skip
def test_whatever_would_come_back_as_something_else_is_refused(value: object) -> None:
    with pytest.raises(Unstorable, match=type(value).__name__):
        Packer().pack([value])


def test_a_refusal_says_what_and_where() -> None:
    with pytest.raises(Unstorable) as caught:
        Packer().pack({"a": (1, Slotted([{1}]))})
    assert caught.value.kind == "set"
    assert caught.value.inside == ("list", "Slotted", "tuple", "dict")
    assert "type set inside list inside Slotted" in str(caught.value)


def test_a_value_that_holds_itself_is_refused() -> None:
    endless: list[object] = []
    endless.append(endless)
    with pytest.raises(Unstorable, match="nested"):
        Packer().pack(endless)


def test_a_value_comes_back_without_being_made_anew() -> None:
    take = Take(np.arange(3.0), "t", Slotted((1, Take(None))))
    back = there_and_back(take)
    assert type(back) is Take
    assert back.name == "t!"  # made anew, it would have a second mark
    assert back.inner.first[1].name == "!"
    assert type(back.inner) is Slotted
    assert back.inner.second == 2
    assert not back.positions.flags.writeable


def test_what_a_value_has_computed_of_itself_is_computed_again() -> None:
    take = Take(np.arange(3.0))
    assert take.size == 3
    back = there_and_back(take)
    assert "size" not in vars(back)
    assert back.size == 3


def test_a_value_with_more_than_its_fields_is_refused() -> None:
    loose = Loose(1)
    loose.more = 2  # type: ignore[attr-defined]
    with pytest.raises(Unstorable, match="more: not among its fields"):
        Packer().pack(loose)


def test_a_value_with_an_empty_field_is_refused() -> None:
    with pytest.raises(Unstorable, match="no value"):
        Packer().pack(object.__new__(Slotted))


def test_a_value_that_is_no_dataclass_is_refused() -> None:
    with pytest.raises(Unstorable, match="dataclass"):
        Packer().pack(NoDataclass())


@pytest.mark.parametrize("base", [dict, list, np.ndarray, ValueError])
def test_a_value_that_is_something_else_besides_is_refused(base: Any) -> None:
    both: Any = dataclass(init=False)(type("Both", (base, Value), {}))
    with pytest.raises(Unstorable, match="Both cannot be kept: it is more than its fields"):
        Packer().pack(both.__new__(both, (2,)))


def test_a_class_that_nobody_could_find_again_is_refused() -> None:
    @dataclass(frozen=True)
    class Inside(Value):
        first: int

    with pytest.raises(Unstorable, match="no class"):
        Packer().pack(Inside(1))


def test_a_class_with_other_fields_by_now_is_not_put_together() -> None:
    head = Packer().pack(Slotted(1)).head.replace('"second"', '"third"')
    with pytest.raises(Unreadable, match="other fields"):
        Packer().unpack(head)


@pytest.mark.parametrize(
    "name",
    [
        "os:system",
        "builtins:object",
        "pathlib:Path",
        "nodegraph:nope",
        ":",
        "nodegraph.node.values:Value",
    ],
)
def test_nothing_but_values_is_put_together(name: str) -> None:
    with pytest.raises(Unreadable, match="not a class of values"):
        Packer().unpack(f'["value","{name}",[]]')


def test_what_is_stored_imports_nothing_that_was_not_allowed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sneaky_one.py").write_text(
        "from dataclasses import dataclass\nfrom nodegraph import Value\n"
        "@dataclass(frozen=True)\nclass Kept(Value):\n    a: int\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    head = '["value","sneaky_one:Kept",["a"],1]'
    with pytest.raises(Unreadable):
        Packer().unpack(head)
    with pytest.raises(Unreadable):
        Packer(packages=lambda name: name == "sneaky").unpack(head)
    assert "sneaky_one" not in sys.modules
    result = Packer(packages=lambda name: name == "sneaky_one").unpack(head)
    monkeypatch.delitem(sys.modules, "sneaky_one")
    assert result.a == 1


def test_a_storage_keeps_what_nothing_else_keeps() -> None:
    back = there_and_back([Thing(1, np.arange(2.0), Thing())], things())
    assert type(back[0]) is Thing
    assert back[0].parts[0] == 1
    assert back[0].parts[1].tolist() == [0, 1]
    assert type(back[0].parts[2]) is Thing


def test_a_storage_that_comes_first_is_asked_first_and_before_what_is_known() -> None:
    packer = Packer(
        [
            Kind(SmallThing, take_apart=lambda thing: "small", put_together=lambda text: text),
            Kind(Thing, take_apart=lambda thing: "any", put_together=lambda text: text),
            Kind(Slotted, take_apart=lambda value: "slotted", put_together=lambda text: text),
        ]
    )
    back = there_and_back((SmallThing(), Thing(), Slotted(1)), packer)
    assert back == ("small", "any", "slotted")


def test_a_storage_that_cannot_keep_this_value_refuses_it() -> None:
    def refuse(thing: Thing) -> object:
        raise TypeError("column 'x' has a time zone")

    with pytest.raises(Unstorable, match="type Thing inside list cannot be kept: column 'x'"):
        Packer([Kind(Thing, take_apart=refuse, put_together=Thing)]).pack([Thing()])


def test_what_nobody_can_put_together_any_more_is_said() -> None:
    head = things().pack(Thing()).head
    with pytest.raises(Unreadable, match=r"no plugin says how to put a .*:Thing together"):
        Packer().unpack(head)


@pytest.mark.parametrize(
    "head",
    [
        "", "{", "[]", "{}", "NaN", "-Infinity", "[[[", "1 2", "é", "[1]", "[null]", "[[]]",
        '["nothing"]', '["array",0,"<f8",[1]]', '["list",{"a":1}]', '["dict",1]', '["dict",[],1]',
        '["dict",1,2,1,3]', '["bytes",3]', '["bytes",-1]', '["bytes"]', '["int","x"]', '["int",1]',
        '["int","1","2"]', '["float","00"]', '["float",1]', '["str","ff"]', '["str","x"]',
        '["path",1]', '["path",["tuple"]]', '["numpy.str",1]', '["numpy.bytes","x"]',
        '["number","<f8","00"]', '["number","|O","0000000000000000"]', '["number","<f8"]',
        '["across"]', '["across",1,2,3,4]', '["across",["tuple",1],["tuple"],["tuple"],["dict"]]',
        '["across",["tuple"],["tuple",["tuple",1,2]],["tuple"],["dict"]]',
        '["across",["tuple"],["tuple"],["tuple",1],["dict"]]', '["absent",1,"refused","x"]',
        '["absent",["dict"],"refused",1]', '["absent",["dict"]]', '["value"]', '["value",1,[],2]',
        '["value","nodegraph.node.values:Files",["content"]]',
        '["stored"]', '["stored",["list"],1]',
    ],
)  # fmt: skip
def test_what_is_no_value_is_unreadable(head: str) -> None:
    with pytest.raises(Unreadable):
        Packer().unpack(head)


def test_every_buffer_has_one_place() -> None:
    for head in ("1", '["bytes",0]', '["list",["bytes",1],["bytes",0]]', '["tuple",["bytes",0]]'):
        with pytest.raises(Unreadable, match="buffer"):
            Packer().unpack(head, [b"a", b"b"])


def test_what_is_kept_is_nested_no_deeper_than_it_can_be_read() -> None:
    value: object = None
    for depth in range(1, 200):
        value = [value]
        try:
            packed = Packer().pack(value)
        except Unstorable:
            assert depth > 50
            break
        assert Packer().unpack(packed.head) == value
    with pytest.raises(Unreadable, match="nested"):
        Packer().unpack('["list",' * depth + "1" + "]" * depth)


def test_a_value_comes_back_if_its_class_takes_its_fields() -> None:
    head = Packer().pack(Checked(2.0, (1, 2))).head
    assert Packer().unpack(head) == Checked(2.0, (1, 2))
    for wrong in ("-2.0", "2", '"x"', "null"):
        with pytest.raises(Unreadable):
            Packer().unpack(head.replace("2.0", wrong))
    with pytest.raises(Unreadable, match=r"Checked\.marks is list, not tuple"):
        Packer().unpack(head.replace('["tuple"', '["list"'))
    packed = Packer().pack(Checked(2.0, (), np.zeros(2)))
    with pytest.raises(Unreadable, match=r"Checked\.numbers is of float32, not of float64"):
        Packer().unpack(packed.head.replace("<f8", "<f4"), [bytes(8)])


def test_a_class_that_ends_the_program_does_not_end_it() -> None:
    with pytest.raises(Unreadable, match="SystemExit"):
        Packer().unpack(Packer().pack(Leaving(1)).head.replace("1", "2"))


def test_a_class_whose_check_needs_more_than_fields_is_refused() -> None:
    with pytest.raises(Unstorable, match="__post_init__"):
        Packer().pack(Scaled(1.0, 2.0))


def test_a_storage_that_fails_makes_nothing() -> None:
    def fail(parts: object) -> Thing:
        raise SystemExit(3)

    head = things().pack(Thing()).head
    with pytest.raises(Unreadable, match="SystemExit"):
        Packer([Kind(Thing, take_apart=Thing, put_together=fail)]).unpack(head)


def test_nothing_stands_in_where_the_value_itself_is_due() -> None:
    packed = things(faithful=False).pack([Thing(1)])
    assert things(faithful=False).unpack(packed.head)[0].parts == [1]
    with pytest.raises(Unreadable, match="stands in for a Thing"):
        things(faithful=False).unpack(packed.head, stand_ins=False)


def test_a_stand_in_is_known_as_one_wherever_it_lies() -> None:
    packer = things(faithful=False)
    assert packer.pack([1.5]).faithful
    assert not packer.pack({"a": (Slotted(Thing()),)}).faithful
    assert things().pack([Thing()]).faithful


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        *(
            (value, True)
            for value in (float, bool, str, bytes, tuple, dict, type(Path()), type(None))
        ),
        *((value, True) for value in (np.ndarray, np.float64, Across, Slotted, SmallThing)),
        *((value, False) for value in (object, set, Colour, Pair, OrderedDict, np.matrix)),
    ],
)
def test_types_that_travel(kind: type, expected: bool) -> None:
    assert things().travels(kind) == expected


def test_types_without_a_faithful_storage_do_not_travel() -> None:
    assert not Packer().travels(Thing)
    assert not things(faithful=False).travels(Thing)


def test_a_reader_is_lent_what_the_storage_says() -> None:
    packer = things(lend=lambda thing: Thing(*thing.parts))
    thing = Thing(1)
    lent = packer.lend(thing)
    assert lent is not thing
    assert lent.parts == [1]
    assert things().lend(thing) is thing
    take = Take(None)
    assert packer.lend(take) is take


def test_digests_differ_where_values_do() -> None:
    packer = Packer()
    values: list[object] = [
        0.0, -0.0, 0, False, "0", b"0", None, (), [], {}, [0], (0,), [[0]], {0: 0}, Path("0"),
        np.zeros(()), np.zeros(1), np.zeros(0), np.zeros((2, 3)), np.zeros((3, 2)),
        np.zeros((2, 3), order="F"), np.zeros(6), np.zeros(6, "f4"), np.zeros(6, ">f8"),
        np.zeros(6, "i8"), np.zeros(12)[::2], np.float64(0), [np.zeros(2), np.zeros(4)],
        [np.zeros(4), np.zeros(2)], [b"ab", b"c"], [b"a", b"bc"],
    ]  # fmt: skip
    digests = [packer.digest(value) for value in values]
    assert len(set(digests)) == len(values)
    assert digests == [packer.digest(packer.pack(value)) for value in values]
    assert {len(value) for value in digests} == {64}


def test_a_digest_covers_every_byte() -> None:
    head = '["array",0,"<f8",[1]]'
    first, other = (Packed(head, (memoryview(bytes([0] * 7 + [last])),)) for last in (0, 1))
    assert first.digest != other.digest


def test_lists_and_mappings_are_lent_as_copies() -> None:
    packer = Packer()
    value = [1, {"a": [2]}]
    lent = packer.lend(value)
    lent[1]["a"].append(3)
    assert value == [1, {"a": [2]}]
    assert packer.lend((1, 2)) == (1, 2)
