"""What holds for the names of all files that a command writes."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from pathlib import Path, PurePosixPath

REFUSED = re.compile(r'[<>:"\\|?*\x00-\x1f\x7f]')
DEVICE = re.compile(r"(con|prn|aux|nul|com[0-9¹²³]|lpt[0-9¹²³]|conin\$|conout\$) *(\..*)?", re.I)
MOST_BYTES, MOST_IN_PATH = 140, 260


def paths_in(folder: Path) -> list[str]:
    """Return the path of every file in a folder, as seen from there."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return sorted(path.relative_to(folder).as_posix() for path in files)


def check_portable(paths: Iterable[str]) -> None:
    """Assert that every system can have these files, and no two of them are one there."""
    every = list(paths)
    for path in every:
        assert len(path.encode()) <= MOST_IN_PATH, path
        for name in PurePosixPath(path).parts:
            assert len(name.encode()) <= MOST_BYTES, name
            assert not REFUSED.search(name), name
            assert not DEVICE.fullmatch(name), name
            assert name[0] not in "-. ", name
            assert name[-1] not in ". ", name
            unprintable = {sign for sign in name if unicodedata.category(sign)[0] in "CZ"}
            assert unprintable <= {" "}, name
    for form in ("NFC", "NFD"):
        assert len({unicodedata.normalize(form, path.casefold()) for path in every}) == len(every)
    folders = {str(above).casefold() for path in every for above in PurePosixPath(path).parents}
    assert folders.isdisjoint(path.casefold() for path in every)
