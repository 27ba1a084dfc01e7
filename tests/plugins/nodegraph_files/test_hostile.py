"""No file, however damaged, is more than refused, by its name, soon and in little memory."""

from __future__ import annotations

import random
import tracemalloc
import warnings
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph_files import (
    csv_bytes,
    head_bytes,
    model_bytes,
    npz_bytes,
    read_c3d,
    read_csv,
    read_live_link,
    read_marker_set_yaml,
    read_model_npz,
    read_mot,
    read_npz,
    read_trc,
    trc_bytes,
)
from nodegraph_files.glb.reading import read_glb
from nodegraph_files.head import read_marker_vertices
from nodegraph_files.obj import read_obj
from nodegraph_files.text.weights import read_weights_table
from nodegraph_mocap.specimens import heads, models
from tests.plugins.nodegraph_files.conftest import a_recording, build

TIMES = 100
LETTERS = b"0123456789:;,.-e\n\t#[]{}&*!?|>%'\"abc"


def damaged(good: bytes, chance: random.Random) -> bytes:
    """Return a content in which bytes, mostly near its start, are changed, moved, added or cut."""
    content = bytearray(good)
    for _ in range(chance.choice([1, 1, 2, 5, 20])):
        if len(content) < 2:
            break
        at = chance.randrange(min(len(content), chance.choice([1500, len(content)])))
        match chance.choice(["byte"] * 6 + ["word", "drop", "add", "text", "repeat", "cut"]):
            case "byte":
                content[at] = chance.choice([0, 1, 127, 128, 254, 255, chance.randrange(256)])
            case "word":
                content[at : at + 4] = chance.choice([b"\xff" * 4, bytes(4), b"\x7f\xff\xff\xff"])
            case "drop":
                content[at : at + chance.randrange(1, 9)] = b""
            case "add":
                content[at:at] = chance.randbytes(chance.randrange(1, 9))
            case "text":
                content[at:at] = chance.choice([b"1e400", b"nan", b"-", b"\n\n", b"\t", b'"' * 9])
            case "repeat":
                content[at:at] = content[at : at + chance.randrange(2000)]
            case "cut":
                del content[at + 1 :]
    return bytes(content)


def damaged_letters(good: bytes, chance: random.Random) -> bytes:
    """Return a damaged content that is text, but for the bytes of an é, which may part."""
    content = damaged(good, chance)
    return bytes(
        byte if byte in b"\t\n\xc3\xa9" or 32 <= byte < 127 else chance.choice(LETTERS)
        for byte in content
    )


def damaged_array(good: bytes, chance: random.Random) -> bytes:
    """Return a sound archive, its sums right, with one damaged array whose header is text."""
    with zipfile.ZipFile(BytesIO(good)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    name = chance.choice(list(members))
    content = damaged(members[name], chance)
    header = bytes(byte if 32 <= byte < 127 else 0x30 + byte % 10 for byte in content[10:127])
    target = BytesIO()
    with zipfile.ZipFile(target, "w") as archive:
        for each, whole in members.items():
            changed = content[:10] + header + content[127:] if each == name else whole
            archive.writestr(each, changed)
    return target.getvalue()


@dataclass(frozen=True)
class Case:
    """A good file, what reads it, and how a refusal goes on after the file's name."""

    content: bytes
    read: Callable[[Path], object]
    says: str = ":"
    is_text: bool = True


def c3d(**settings: Any) -> Case:
    samples = np.zeros((20, 3, 4))
    samples[..., :3] = np.random.default_rng(0).integers(-8000, 8000, size=(20, 3, 3)) / 8
    content = build(samples, **settings)
    return Case(content, read_c3d, ": not a readable C3D recording", is_text=False)


def text(content: str, read: Callable[[Path], object] = read_csv, says: str = ":") -> Case:
    return Case(content.encode(), read, says)


MODEL = models()["complete"]
HEAD = heads()["complete"]
LIVE_LINK = "Timecode,BlendShapeCount,JawOpen,EyeBlinkLeft\n" + "".join(
    f"00:00:{count // 60:02}:{count % 60:02}.000,2,{count / 1e3},0.5\n" for count in range(50, 70)
)
MARKER_SET = (
    "markers: [a, b, c]\npairs:\n  - [a, b]\nmidline: [c]\nstable: &s [c]\nedges: [[a, c]]\n"
)
CASES = {
    "C3D, Intel, floats": c3d(),
    "C3D, Intel, integers": c3d(scale=0.125, analog=2),
    "C3D, DEC, floats": c3d(processor=85, analog=1),
    "C3D, MIPS, integers": c3d(processor=86, scale=0.125),
    "C3D, frames of the trial": c3d(trial=(1, 20)),
    "NPZ": Case(npz_bytes(a_recording()), read_npz, ": not a readable NPZ recording", False),
    "model": Case(model_bytes(MODEL), read_model_npz, ": not a readable NPZ model", False),
    "GLB": Case(head_bytes(HEAD), read_glb, ": not a readable GLB head: ", False),
    "OBJ": text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n", read_obj),
    "marker vertices": text(
        "marker,vertex\nnose,9\nchin,0\n", lambda path: read_marker_vertices(path, 10)
    ),
    "marker set": text(MARKER_SET, read_marker_set_yaml, ": not a marker set: "),
    "CSV": Case(csv_bytes(a_recording()), read_csv),
    "TRC": Case(trc_bytes(a_recording()), read_trc),
    "MOT": text("it\nUnits=mm\nendheader\ntime\ta_x\ta_y\ta_z\n0\t1\t2\t3\n1\t1\t2\t3\n", read_mot),
    "Live Link": text(LIVE_LINK, read_live_link),
    "weights": text("time,jawOpen,smile\n0,0.5,1\n0.1,0.25,1\n0.2,,1\n", read_weights_table),
    "long": text("# rate: 60\nframe,marker,x,y,z\n0,a,1,2,3\n1,a,1,2,3\n1,b,4,5,6\n"),
    "levels": text("# rate: 60\n,a,a,a\n,x,y,z\n0,1,2,3\n1,4,5,6\n"),
    "QTM": text("NO_OF_FRAMES\t2\nFREQUENCY\t60\nMARKER_NAMES\ta\n1\t2\t3\n4\t5\t6\n"),
    "Motive": text(
        "Format Version,1.23,Export Frame Rate,60,Length Units,Millimeters\n\n"
        ",,Marker,Marker,Marker\n,,a,a,a\n,,1,1,1\n,,Position,Position,Position\n"
        "Frame,Time,X,Y,Z\n0,0,1,2,3\n1,0.016667,1,2,3\n"
    ),
    "Vicon": text(
        "Trajectories\n60\n,,a,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,1,2,3\n2,0,4,5,6\n"
    ),
}
TEXTS = [name for name, case in CASES.items() if case.is_text]
BINARY = [name for name in CASES if name not in TEXTS]

pytestmark = pytest.mark.filterwarnings("ignore")


def refused(path: Path, case: Case, content: bytes) -> bool:
    """Return whether a content is refused, as the format says it."""
    path.unlink(missing_ok=True)  # ext4 writes a file to the disk at once if it was emptied
    path.write_bytes(content)
    try:
        case.read(path)
    except ValueError as error:
        message = str(error)
    else:
        return False
    assert message.startswith(f"{path}{case.says}"), message
    return True


@pytest.mark.parametrize(
    ("name", "damage"),
    [
        *((name, damaged) for name in CASES),
        *((name, damaged_letters) for name in TEXTS),
        ("NPZ", damaged_array),
        ("model", damaged_array),
    ],
)
def test_a_damaged_file_is_read_or_refused(
    name: str,
    damage: Callable[[bytes, random.Random], bytes],
    tmp_path: Path,
    peak_memory: Callable[[], int],
) -> None:
    case, chance, path = CASES[name], random.Random(name), tmp_path / "it"
    assert not refused(path, case, case.content)
    held = tracemalloc.get_traced_memory()[0]  # what is imported to read stays
    tracemalloc.reset_peak()
    count = sum(refused(path, case, damage(case.content, chance)) for _ in range(TIMES))
    assert TIMES / 8 < count < TIMES
    assert peak_memory() - held < 20_000_000


@pytest.mark.parametrize("name", CASES)
def test_a_file_cut_short_is_refused_or_warned_of_where_that_shows(
    name: str, tmp_path: Path
) -> None:
    case, path = CASES[name], tmp_path / "it"
    whole = len(case.content)
    places = [*range(0, whole, -(-whole // 200)), whole - 1]
    count = 0
    for length in places:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            is_refused = refused(path, case, case.content[:length])
        count += is_refused or any("cut short" in str(warning.message) for warning in caught)
    assert count == len(places) if name in BINARY else count > 0


@pytest.mark.parametrize("name", CASES)
def test_what_is_no_such_file_is_refused(name: str, tmp_path: Path) -> None:
    case, path, chance = CASES[name], tmp_path / "it", random.Random(name)
    others = [
        b"",
        bytes(5000),
        b"hello, this is text",
        b"glTF\2\0",
        b"PK\x03\x04",
        b"\2\x50",
        b"\2",
    ]
    others += [
        other.content for each, other in CASES.items() if (each in BINARY) != (name in BINARY)
    ]
    assert all(refused(path, case, other) for other in others)
    for _ in range(100):
        content = case.content[: chance.choice([1, 2, 4, 16])] + chance.randbytes(3000)
        assert refused(path, case, content)


@pytest.mark.parametrize("name", TEXTS)
def test_a_text_in_utf_16_that_does_not_say_so_is_refused(name: str, tmp_path: Path) -> None:
    case = CASES[name]
    assert refused(tmp_path / "it", case, case.content.decode().encode("utf-16-le"))
