"""``nodegraph cite``."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Mapping
from pathlib import Path

from nodegraph.cli.common import refuse_unwritable, say, written
from nodegraph.errors import NodegraphError


def cite(arguments: Namespace) -> int:
    """Print what a paper says of a run, or write it as files: Markdown, LaTeX and BibTeX."""
    from nodegraph.report.citing import cited
    from nodegraph.report.files import read_study

    study = read_study(arguments.run)
    texts = cited(study)
    if arguments.out is None:
        print("\n".join(texts[name] for name in texts if not name.endswith(".tex")).rstrip())
    else:
        _write(texts, arguments.out)
    for one in study.without_result:
        say(f"not named, as it gave no result: {one}")
    return 0


def _write(texts: Mapping[str, str], folder: Path) -> None:
    """Write all of the texts, or none."""
    for name in texts:
        if (folder / name).exists():
            raise NodegraphError(
                f"{folder / name} is there already; name another folder, or remove it first"
            )
        refuse_unwritable(folder / name)
    for name, text in texts.items():
        written(folder / name, text.encode(errors="backslashreplace"))
        print(folder / name)
