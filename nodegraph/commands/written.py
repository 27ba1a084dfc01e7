"""Files that a command writes where the user says."""

from __future__ import annotations

from pathlib import Path

from nodegraph.display import size_text


def written(path: Path, content: bytes) -> None:
    """Write a file whole or not at all, with the folders that it needs."""
    unfinished = path.with_name(f"{path.name}.part")
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished.write_bytes(content)
    unfinished.replace(path)


def written_and_told(path: Path, content: bytes) -> None:
    """Write a file whole or not at all, and print where it is and how large."""
    written(path, content)
    print(f"{path} ({size_text(len(content))})")
