"""The README of an archive."""

from __future__ import annotations

from collections.abc import Iterator

from nodegraph.archive.contents import Contents


def readme(contents: Contents) -> str:
    """Return the text of the README in Markdown."""
    study = contents.study
    version = dict(study.versions).get("nodegraph", "")
    missing = ", and with what is not in this archive" if contents.missing else ""
    lines = [
        f"# {study.title}",
        "",
        f"A run of `{contents.graph}` by nodegraph {version}, made {study.created}. "
        "Its report is `run/report.html`; what to cite is in `citation/`; "
        "`ro-crate-metadata.json` describes every file (Workflow Run RO-Crate 0.5).",
        "",
        *study.answer,
        "",
        f"Run it again here, with the same versions of the packages below{missing}:",
        "",
        f"    {contents.command}",
        "",
        *_verify(contents),
        *_inputs(contents),
        *_missing(contents),
        "Paths are those in this archive; folders of the machine that ran it are left out.",
        "",
        ", ".join(f"{name} {version}" for name, version in study.versions),
        "",
    ]
    return "\n".join(lines)


def _verify(contents: Contents) -> Iterator[str]:
    lock = next((name for name in contents.files if name.endswith(".lock")), "")
    if lock and "/" not in lock:
        yield f"Verify that it still has the same results: `nodegraph verify {lock}`"
        yield ""


def _inputs(contents: Contents) -> Iterator[str]:
    if contents.inputs:
        yield "Input files, with the SHA-256 of their content and their suffix:"
        yield ""
        for file in contents.inputs:
            shipped = ", part of its package" if file.is_shipped else ""
            yield f"- `{file.name}`{shipped}: {file.digest}"
        yield ""


def _missing(contents: Contents) -> Iterator[str]:
    if contents.missing:
        yield "Not in this archive:"
        yield ""
        yield from (f"- {text}" for text in contents.missing)
        yield ""
