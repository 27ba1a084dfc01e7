"""Portable names of files: every system accepts them, and no disk takes two of them for one.

The name of a result depends on nothing but its labels. Plain labels stand in it as they are; any
other leaves a readable name that ends with a digest, as do names that are too long.
"""

from __future__ import annotations

import hashlib
import json
import re
import unicodedata
from collections.abc import Iterable, Sequence

MAX_BYTES = 255
"""Bytes that the name of a file can have on the disks in use."""

_MAX_STEM = 100
"""Bytes of a name without its suffix; few, because Windows limits whole paths."""
_MAX_PATH = 120
_DIGEST = 12
_MAX_BEFORE_DIGEST = _MAX_STEM - _DIGEST - 1
_WITH_DIGEST = re.compile(rf"(.*-)?[0-9a-f]{{{_DIGEST}}}", re.DOTALL)
_SUFFIX = re.compile(r"(?<=.)\.[A-Za-z0-9]{1,15}$")
_PLAIN = re.compile(r"(?!(0|[1-9][0-9]*|inf)\Z)\w*")
"""Labels that are names as they are; not those that read as a number, which is one too."""
_REFUSED = frozenset('<>:"/\\|?*')
_DEVICE = re.compile(
    r"(con|prn|aux|nul|(com|lpt)[0-9¹²³]|con(in|out)\$) *(\..*)?", re.I | re.DOTALL
)
"""Names that Windows takes for a device, whatever follows the first point."""


def fold(name: str) -> str:
    """Return the same text for all names that some disk takes for one.

    A disk may ignore the case of letters, and how an accented letter is composed.
    """
    return unicodedata.normalize("NFC", unicodedata.normalize("NFKC", name).casefold())


def file_stem(words: Sequence[Sequence[object]], *, digest: bool = False) -> str:
    """Return the name, without a suffix, of the file that several words describe.

    Parameters
    ----------
    words
        Each in its parts: an axis and its label. Plain are numbers, and texts in lower case of
        letters, digits and underscores, for which the name has hyphens.
    digest
        Whether the name ends with a digest in any case.

    Examples
    --------
    >>> file_stem([["table"], ["fill", "lin_ouhyoung"], ["length", 5]])
    'table_fill-lin-ouhyoung_length-5'
    >>> file_stem([["table"], ["length", "<5"]])
    'table_length-5-51360bbc15d3'
    """
    name = "_".join("-".join(map(_slug, word)) for word in words)
    is_plain = all(_is_plain_name(name) and all(map(_is_plain, rest)) for name, *rest in words)
    return name if is_plain and not digest and _is_accepted(name) else _with_digest(name, words)


def portable_name(name: str, *, digest: bool = False) -> str:
    """Return the name of a file as every system accepts it, which mostly is that name.

    Parameters
    ----------
    name
    digest
        Whether the name has a digest before its suffix in any case.

    Examples
    --------
    >>> portable_name("take 1.c3d")
    'take 1.c3d'
    >>> portable_name("why?.csv")
    'why-fb27856a81e3.csv'
    """
    suffix = match[0] if (match := _SUFFIX.search(name)) else ""
    stem = name.removesuffix(suffix)
    accepted = "".join("-" if _is_refused(character) else character for character in stem)
    if not digest and accepted == stem and _is_accepted(stem):
        return name
    return _with_digest(accepted, name) + suffix


def portable_paths(paths: Iterable[str]) -> dict[str, str]:
    """Return portable paths for those of all files in a folder, written with slashes.

    No disk takes two of them for one file, or one of them for a folder: of two paths that some
    disk takes for one, the later leaves its folder and gets a digest.
    """
    portable: dict[str, str] = {}
    files, folders = set[str](), set[str]()
    for path in paths:
        name = "/".join(map(portable_name, path.split("/")))
        above = _folders(fold(name))
        is_long = len(name.encode()) > _MAX_PATH
        if is_long or fold(name) in files | folders or not files.isdisjoint(above):
            last = portable_name(path.rpartition("/")[2])
            suffix = match[0] if (match := _SUFFIX.search(last)) else ""
            name, above = _with_digest(last.removesuffix(suffix), ["path", path]) + suffix, ()
        portable[path] = name
        files.add(fold(name))
        folders.update(above)
    return portable


def shorten(text: str, size: int) -> str:
    """Return the longest prefix of a text that fits into a number of bytes."""
    encoded = text.encode(errors="replace")
    return text if len(encoded) <= size else encoded[:size].decode(errors="ignore")


def _folders(path: str) -> Sequence[str]:
    parts = path.split("/")
    return ["/".join(parts[:count]) for count in range(1, len(parts))]


def _slug(part: object) -> str:
    return re.sub(r"[^\w.]|_", "-", unicodedata.normalize("NFC", str(part)))


def _is_plain(label: object) -> bool:
    if isinstance(label, str):
        return _PLAIN.fullmatch(label) is not None and fold(label) == label
    return _slug(label) == str(label) and not isinstance(label, bool)


def _is_plain_name(name: object) -> bool:
    return _is_plain(str(name).replace(".", ""))  # a node of a graph used as a node


def _is_accepted(stem: str) -> bool:
    """Return whether a name of characters that every system accepts needs no digest."""
    return (
        0 < len(stem.encode()) <= _MAX_STEM
        and stem[0] not in "-. "
        and stem[-1] not in ". "
        and unicodedata.is_normalized("NFC", stem)
        and not _WITH_DIGEST.fullmatch(stem)
        and not _DEVICE.fullmatch(stem)
    )


def _is_refused(character: str) -> bool:
    """Return whether some system refuses a character."""
    is_other = unicodedata.category(character)[0] in "CZ" and character != " "
    return is_other or character in _REFUSED


def _with_digest(readable: str, identity: object) -> str:
    text = re.sub("-{2,}", "-", unicodedata.normalize("NFC", readable)).lstrip("-. ")
    text = shorten(text, _MAX_BEFORE_DIGEST).rstrip("-. ")
    text = text.replace(".", "-") if _DEVICE.fullmatch(text) else text
    digest = hashlib.sha256(json.dumps(identity).encode()).hexdigest()[:_DIGEST]
    return f"{text}-{digest}" if text else digest
