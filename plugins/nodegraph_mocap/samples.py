"""Recordings that come with the package, so that every graph runs as it stands."""

from __future__ import annotations

from pathlib import Path

from nodegraph import NodegraphError, nearest

_FOLDER = Path(__file__).parent / "samples"


def sample_folder(name: str) -> Path:
    """Return the folder of a sample, from which each reader takes its file.

    Parameters
    ----------
    name
        ``face`` (ten seconds with noise, gaps and impulses), or ``actor_a``, ``actor_b``,
        ``actor_c`` (three other faces, complete and without impulses).

    Raises
    ------
    NodegraphError
        If there is no such sample; the message lists those that there are.
    """
    known = sorted(folder.name for folder in _FOLDER.glob("*/"))
    if name in known:
        return _FOLDER / name
    raise NodegraphError(f"no sample {name!r}; {nearest(name, known)}")
