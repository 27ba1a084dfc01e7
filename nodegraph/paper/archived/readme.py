"""What a person reads first who unpacks the archive of a run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nodegraph.paper.archived.contents import Contents


def readme(contents: Contents) -> str:
    """Return the text of an archive's README, in Markdown."""
    study = contents.study
    versions = dict(study.versions)
    lines = [
        f"# {study.title}",
        "",
        f"A run of `{contents.graph}` by nodegraph {versions.get('nodegraph', '')}, made "
        f"{study.created}. Its report is `run/report.html`; what to cite is in `citation/`; "
        "`ro-crate-metadata.json` describes every file (Workflow Run RO-Crate 0.5).",
        "",
        *study.answer,
        "",
        f"Run it again here, with the same versions of the packages below{_once(contents)}:",
        "",
        f"    {contents.command}",
        "",
        *_verify(contents),
        *_inputs(contents),
        *_lacking(contents),
        "Paths are those in this archive; folders of the machine that ran it are left out.",
        "",
        ", ".join(f"{name} {one}" for name, one in study.versions),
        "",
    ]
    return "\n".join(lines)


def _once(contents: Contents) -> str:
    return ", and with what is not in this archive" if contents.lacking else ""


def _verify(contents: Contents) -> Iterator[str]:
    lock = next((name for name in contents.files if name.endswith(".lock")), "")
    if lock and "/" not in lock:
        yield f"and tell whether it still gives its results: `nodegraph verify {lock}`"
        yield ""


def _inputs(contents: Contents) -> Iterator[str]:
    if contents.inputs:
        yield "It read (with the SHA-256 of the content, and its suffix):"
        yield ""
        for one in contents.inputs:
            shipped = ", which its package ships" if one.is_shipped else ""
            yield f"- `{one.name}`{shipped}: {one.digest}"
        yield ""


def _lacking(contents: Contents) -> Iterator[str]:
    if contents.lacking:
        yield "Not in this archive:"
        yield ""
        yield from (f"- {one}" for one in contents.lacking)
        yield ""
