"""Portable names of files: every system accepts them, and no disk takes two of them for one.

A name is the plain one wherever possible. Where that would not identify its file, because of
characters that some system refuses, labels that differ in case only, or its length, the name stays
readable and ends with a digest of what it stands for.
"""

from __future__ import annotations

import hashlib
import json
import re
import unicodedata
from collections import Counter, defaultdict
from collections.abc import Hashable, Iterable, Sequence
from typing import TypeVar

T = TypeVar("T", bound=Hashable)

MAX_BYTES = 255
"""Bytes that the name of a file can have on the disks in use."""

_MAX_STEM = 100
"""Bytes of a name without its suffix; few, because Windows limits whole paths."""
_MAX_PATH = 120
_DIGEST = 12
_MAX_BEFORE_DIGEST = _MAX_STEM - _DIGEST - 1
_WITH_DIGEST = re.compile(rf"(.*-)?[0-9a-f]{{{_DIGEST}}}", re.DOTALL)
_SUFFIX = re.compile(r"(?<=.)\.[A-Za-z0-9]{1,15}$")
_HYPHENS = re.compile("-{2,}")
_RESERVED_CHARACTERS = frozenset('<>:"/\\|?*')
_DEVICES = frozenset(
    {"con", "prn", "aux", "nul", "conin$", "conout$"}
    | {f"{port}{number}" for port in ("com", "lpt") for number in "0123456789¹²³"}
)


def fold(name: str) -> str:
    """Return the same text for all names that some disk takes for one.

    A disk may ignore the case of letters, and how an accented letter is composed.
    """
    return unicodedata.normalize("NFC", unicodedata.normalize("NFKC", name).casefold())


def clashes(words: Iterable[T]) -> frozenset[T]:
    """Return the words that need a digest in `file_stem` to have a name of their own.

    A word in lower case without underscores keeps its name, and is not returned.
    """
    names = {word: fold(_hyphenated(str(word))) for word in words}
    counts = Counter(names.values())
    return frozenset(word for word, name in names.items() if counts[name] > 1 and word != name)


def file_stem(words: Sequence[Sequence[object]], *, exact: bool = True) -> str:
    """Return the name, without a suffix, of the file that several words describe.

    Parameters
    ----------
    words
        Each in its parts: an axis and its label.
    exact
        Whether the words need no digest to differ from all others; see `clashes`.

    Examples
    --------
    >>> file_stem([["table"], ["fill", "lin_ouhyoung"], ["length", 5]])
    'table_fill-lin-ouhyoung_length-5'
    >>> file_stem([["table"], ["length", "<5"]])
    'table_length-5-51360bbc15d3'
    """
    name = "_".join(_hyphenated("-".join(map(str, word))) for word in words)
    if exact and all(_in_word(character) == character for character in name) and _is_plain(name):
        return name
    texts = ["-".join(filter(None, map(_readable, word))) for word in words]
    if len("_".join(texts).encode()) > _MAX_BEFORE_DIGEST:
        share = _MAX_BEFORE_DIGEST // len(texts) - 1
        texts = [shorten(text, max(share, 1)).rstrip("-.") for text in texts]
    return _with_digest("_".join(filter(None, texts)), words)


def portable_name(name: str, *, exact: bool = True, identity: str = "") -> str:
    """Return the name of a file as every system accepts it, which mostly is that name.

    Parameters
    ----------
    name
    exact
        Whether the name needs no digest to differ from all others.
    identity
        What the digest is of; by default, the name.

    Examples
    --------
    >>> portable_name("take 1.c3d")
    'take 1.c3d'
    >>> portable_name("why?.csv")
    'why-fb27856a81e3.csv'
    """
    suffix = match[0] if (match := _SUFFIX.search(name)) else ""
    stem = name.removesuffix(suffix)
    accepted = "".join(map(_in_name, stem))
    if exact and accepted == stem and _is_plain(stem):
        return name
    return _with_digest(accepted, identity or name) + suffix


def portable_paths(paths: Iterable[str]) -> dict[str, str]:
    """Return portable paths for those of all files in a folder, written with slashes.

    No disk takes two of them for one file, or one of them for a folder.
    """
    every = list(paths)
    portable = _portable_paths(path for path in every if not _is_long(path))
    return {
        path: portable[path]
        if path in portable and not _is_long(portable[path])
        else portable_name(path.rpartition("/")[2], exact=False, identity=path)
        for path in every
    }


def shorten(text: str, size: int) -> str:
    """Return the longest prefix of a text that fits into a number of bytes."""
    encoded = text.encode(errors="replace")
    return text if len(encoded) <= size else encoded[:size].decode(errors="ignore")


def _portable_paths(paths: Iterable[str]) -> dict[str, str]:
    inside: dict[str, list[str]] = defaultdict(list)
    for path in paths:
        first, _, rest = path.partition("/")
        inside[first].append(rest)
    counts = Counter(map(fold, inside))
    portable: dict[str, str] = {}
    for first, rests in inside.items():
        name = portable_name(first, exact=counts[fold(first)] == 1 or fold(first) == first)
        below = _portable_paths(rest for rest in rests if rest)
        portable |= {f"{first}/{rest}": f"{name}/{path}" for rest, path in below.items()}
        if "" in rests:
            is_folder = bool(below)
            portable[first] = (
                portable_name(first, exact=False, identity=f"./{first}") if is_folder else name
            )
    return portable


def _is_long(path: str) -> bool:
    return len(path.encode(errors="ignore")) > _MAX_PATH


def _is_plain(stem: str) -> bool:
    """Whether a name of portable characters needs no other change."""
    return (
        0 < len(stem.encode()) <= _MAX_STEM
        and stem[0] not in "-. "
        and stem[-1] not in ". "
        and unicodedata.is_normalized("NFC", stem)
        and not _WITH_DIGEST.fullmatch(stem)
        and not _is_device(stem)
    )


def _is_device(name: str) -> bool:
    """Whether Windows takes a name for a device, whatever follows its first point."""
    return name.partition(".")[0].rstrip().casefold() in _DEVICES


def _with_digest(readable: str, identity: object) -> str:
    text = unicodedata.normalize("NFC", _HYPHENS.sub("-", readable)).lstrip("-. ")
    text = shorten(text, _MAX_BEFORE_DIGEST).rstrip("-. ")
    text = text.replace(".", "-") if _is_device(text) else text
    digest = hashlib.sha256(json.dumps(identity).encode()).hexdigest()[:_DIGEST]
    return f"{text}-{digest}" if text else digest


def _readable(part: object) -> str:
    text = unicodedata.normalize("NFC", str(part))
    return _HYPHENS.sub("-", "".join(map(_in_word, _hyphenated(text)))).strip("-.")


def _hyphenated(word: str) -> str:
    """Return a word without underscores, which separate words."""
    return word.replace("_", "-")


def _in_word(character: str) -> str:
    is_mark = unicodedata.category(character)[0] == "M"
    return character if character.isalnum() or character in ".-_" or is_mark else "-"


def _in_name(character: str) -> str:
    is_other = unicodedata.category(character)[0] in "CZ" and character != " "
    return "-" if is_other or character in _RESERVED_CHARACTERS else character
