"""Entries whose checksum is right and whose content no run has written."""

from __future__ import annotations

import base64
import copy
import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from random import Random
from typing import Any

Change = Callable[[dict[str, Any]], object]
Place = tuple[Any, str | int]

PARTS: tuple[object, ...] = (
    None, True, False, 0, 1, -1, 3, 2**31, 2**40, 2**62, 2**63, 2**70, -(2**40), 0.5, -0.0, 1e308,
    "", "x", "é", "\ud83d", "00", "0x1", "ff" * 8, "a" * 64, "/etc/../x", "|O", "O", "<f8", ">f8",
    "<i8", "|b1", "|u1", "<U1", "<U3", "<U536870911", "|V8", "<M8[ns]", "<m8[s]", "<g", "<f2",
    "numpy", "objects", "text", "categorical", "integer", "range", "multi", "index", [], {}, [[]],
    {"a": 1}, ["list"], ["tuple"], ["dict"], ["int", "0x" + "f" * 99], ["float", "00" * 8],
    ["str", "ff"], ["bytes", 0], ["bytes", 9], ["path", 1], ["path", "x"], ["numpy.str", 1],
    ["number", "|O", "00" * 8], ["number", "<f8", "00" * 8], ["array", 0, "|O", [4]],
    ["array", 0, "<f8", [2**40]], ["array", 0, "<f8", [2**40, 0]], ["array", 0, "<f8", [1] * 99],
    ["array", 0, "<f8", [4], [0], [2**40]], ["array", 0, "<f8", [-1]], ["array", 1, "|u1", [0]],
    ["value", "os:system", []], ["value", "nodegraph.node.values:Files", ["content"], 5],
    ["stored", "nodegraph_tables.types:Table", {}], ["stored", "x:y", 1], ["across", 1, 2, 3, 4],
    ["absent", ["dict"], "refused", "x"], ["tuple", "range", 0, 2**40, 1, None],
)  # fmt: skip
WORDS = (
    "array", "list", "tuple", "dict", "int", "float", "str", "bytes", "path", "number", "value",
    "stored", "across", "absent", "numpy.str", "numpy.bytes", "nothing",
)  # fmt: skip


def deep(levels: int, word: str = "list") -> object:
    """Return lists in lists."""
    part: object = 1
    for _ in range(levels):
        part = [word, part]
    return part


def entry_files(store: Path) -> list[Path]:
    """Return the files of all entries."""
    return sorted(store.glob("format-*/entries/*.json"))


def payload(path: Path) -> dict[str, Any]:
    """Return what an entry's file holds below its checksum."""
    data: dict[str, Any] = json.loads(path.read_bytes()[65:])
    return data


def seal(path: Path, content: bytes) -> None:
    """Write an entry's file, with the checksum that its content has."""
    path.write_bytes(hashlib.sha256(content).hexdigest().encode() + b"\n" + content)


def forge(path: Path, change: Change) -> None:
    """Change what an entry's file holds, such that its checksum is right."""
    data = payload(path)
    change(data)
    seal(path, json.dumps(data).encode())


def output(head: object, *buffers: bytes | Sequence[object] | None, at: int = 0) -> Change:
    """Return a change that makes an output another one, its digest included.

    Parameters
    ----------
    head
        A text as it stands, or what is written as JSON.
    buffers
        Bytes; where a blob lies; or None for where the output's own first one does.
    at
        Which output.
    """
    text = head if isinstance(head, str) else json.dumps(head)

    def change(data: dict[str, Any]) -> None:
        own = data["outputs"][at][1]
        parts = [
            own[0] if buffer is None else _inline(buffer) if isinstance(buffer, bytes) else buffer
            for buffer in buffers
        ]
        data["outputs"][at] = [text, parts]
        data["digests"][at] = digest(text, parts)

    return change


def digest(head: str, parts: Sequence[Any]) -> str:
    """Return the digest that an output of that text and these buffers has."""
    sums = [
        part[0] if isinstance(part, list) else hashlib.sha256(base64.b64decode(part)).hexdigest()
        for part in parts
    ]
    return hashlib.sha256("\n".join([head, *sums]).encode()).hexdigest()


def any_change(chance: Random) -> Change:
    """Return a change somewhere in an entry; what outputs hold has another digest then."""

    def change(data: dict[str, object]) -> None:
        for _ in range(chance.choice([1, 1, 1, 2, 3])):
            container, key = chance.choice(list(_places(data)))
            container[key] = _another(container[key], data, chance)

    return change


def any_other_output(chance: Random) -> Change:
    """Return a change within an output whose digest is made to fit."""

    def change(data: dict[str, Any]) -> None:
        at = chance.randrange(len(data["outputs"]))
        head, parts = data["outputs"][at]
        if not isinstance(head, str):
            return
        if chance.random() < 0.2 and parts:
            parts = _other_buffers(parts, chance)
        else:
            root = [json.loads(head)]
            for _ in range(chance.choice([1, 1, 1, 2, 3])):
                container, key = chance.choice(list(_places(root)))
                container[key] = _another(container[key], root, chance)
            head = json.dumps(root[0])
        data["outputs"][at] = [head, parts]
        data["digests"][at] = digest(head, parts)

    return change


def any_bytes(path: Path, chance: Random) -> None:
    """Change some bytes of an entry's file, such that its checksum is right."""
    content = bytearray(path.read_bytes()[65:])
    for _ in range(chance.randint(1, 4)):
        at, size = chance.randrange(len(content) + 1), chance.choice([0, 1, 1, 2, 9])
        new = chance.choice([b"", chance.randbytes(1), b"9" * 20, b"[" * 3, b"null,", b'\\ud800"'])
        content[at : at + size] = new
    seal(path, bytes(content))


def _inline(content: bytes) -> str:
    return base64.b64encode(content).decode()


def _places(data: Any) -> Iterator[Place]:
    pairs = data.items() if isinstance(data, dict) else enumerate(data)
    for key, part in pairs:
        yield data, key
        if isinstance(part, (dict, list)):
            yield from _places(part)


def _another(part: Any, data: Any, chance: Random) -> object:
    """Return what a mutation makes of a part of data."""
    ways = ["other", "other", "elsewhere", "deep"]
    if isinstance(part, list) and part:
        ways += ["shorter", "longer", "word", "swapped", "twice"] * 2
    if isinstance(part, (int, float)):
        ways += ["number"] * 4
    if isinstance(part, str):
        ways += ["text"] * 4
    way = chance.choice(ways)
    if way == "elsewhere":
        container, key = chance.choice(list(_places(data)))
        return copy.deepcopy(container[key])
    if way == "deep":
        return deep(chance.choice([90, 110, 400]), chance.choice(WORDS))
    if way == "number":
        return part + chance.choice([1, -1, 2**20, 2**33, -(2**33), 0.5])
    if way == "text":
        at = chance.randrange(len(part) + 1)
        return part[:at] + chance.choice(["", "0", "f", "é", "\0", "<", part]) + part[at + 1 :]
    if way in ("shorter", "longer", "word", "swapped", "twice"):
        return _other_list(list(part), way, chance)
    return copy.deepcopy(chance.choice(PARTS))


def _other_list(parts: list[object], way: str, chance: Random) -> list[object]:
    at, other = chance.randrange(len(parts)), chance.randrange(len(parts))
    if way == "shorter":
        del parts[at]
    elif way == "longer":
        parts.insert(at, copy.deepcopy(chance.choice(PARTS)))
    elif way == "word":
        parts[0] = chance.choice(WORDS)
    elif way == "twice":
        parts.insert(at, copy.deepcopy(parts[other]))
    else:
        parts[at], parts[other] = parts[other], parts[at]
    return parts


def _other_buffers(parts: list[Any], chance: Random) -> list[object]:
    parts, at = list(parts), chance.randrange(len(parts))
    way = chance.choice(["gone", "twice", "cut", "random", "size", "name"])
    if way == "gone":
        del parts[at]
    elif way == "twice":
        parts.insert(chance.randrange(len(parts)), parts[at])
    elif isinstance(parts[at], list):
        name, size = parts[at]
        other = [name, chance.choice([0, size + 1, 2**50, -1])]
        parts[at] = other if way != "name" else ["../" * 20 + "etc/passwd", size]
    else:
        content = base64.b64decode(parts[at])
        new = content[:-1] if way == "cut" else chance.randbytes(len(content))
        parts[at] = _inline(new)
    return parts
