"""Finds the file that a path means: the file itself, or one in a folder."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from nodegraph import NodegraphError, listed, nearest, quoted

SAMPLES = Path(__file__).parent / "samples"
"""A folder for each sample."""


def sample_folder(name: str) -> Path:
    """Return the folder of a sample, from which each reader takes its file.

    Parameters
    ----------
    name
        ``face`` (ten seconds with noise, gaps and impulses), ``face_1`` to ``face_8`` (eight other
        faces, damaged alike, eight seconds each), or ``actor_a``, ``actor_b``, ``actor_c`` (three
        more, complete and without impulses).

    Raises
    ------
    NodegraphError
        If there is no such sample; the message lists those that there are.
    """
    known = sorted(folder.name for folder in SAMPLES.glob("*/"))
    if name in known:
        return SAMPLES / name
    raise NodegraphError(f"no sample {quoted(name)}; {nearest(name, known)}")


_SCHEME = "sample:"


def is_sample(settings: Mapping[str, Any]) -> bool:
    """Whether a reader's path is that of a sample, all of which are synthetic."""
    path = str(settings["path"])
    return path.startswith(_SCHEME) or SAMPLES in Path(path).parents or Path(path) == SAMPLES


def find_file(path: Path | str, wanted: tuple[str, ...]) -> Path:
    """Return the file that a reader is to open.

    Parameters
    ----------
    path
        A file, a folder that holds one of the wanted names, or ``sample:NAME``.
    wanted
        File names to look for in a folder, the best first.

    Raises
    ------
    ValueError
        If there is no such file, or it is empty.
    """
    text = str(path)
    file = sample_folder(text.removeprefix(_SCHEME)) if text.startswith(_SCHEME) else Path(path)
    if file.is_dir():
        file = _from_folder(file, wanted)
    if not file.is_file():
        raise ValueError(f"{path}: no such file")
    if not file.stat().st_size:
        raise ValueError(f"{path}: the file is empty")
    return file


def _from_folder(folder: Path, wanted: tuple[str, ...]) -> Path:
    for name in wanted:
        if (folder / name).is_file():
            return folder / name
    there = listed(sorted(file.name for file in folder.iterdir()))
    raise ValueError(f"{folder}: the folder holds no {' or '.join(wanted)}; there is {there}")
