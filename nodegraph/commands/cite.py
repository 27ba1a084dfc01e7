"""``nodegraph cite``."""

from __future__ import annotations

from argparse import Namespace

from nodegraph.errors import NodegraphError


def cite(arguments: Namespace) -> int:
    """Print what a paper says of a run, or write it as files: Markdown, LaTeX and BibTeX."""
    from nodegraph.paper.citing import cited
    from nodegraph.report.saved import read_study

    texts = cited(read_study(arguments.run))
    if arguments.out is None:
        print("\n".join(texts[name] for name in texts if not name.endswith(".tex")).rstrip())
        return 0
    taken = [name for name in texts if (arguments.out / name).exists()]
    if taken:
        raise NodegraphError(
            f"{arguments.out / taken[0]} is there already; name another folder, or remove it first"
        )
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        (arguments.out / name).write_text(text, encoding="utf-8", errors="backslashreplace")
        print(arguments.out / name)
    return 0
