"""``nodegraph cite``: what a paper needs to say about a run."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from nodegraph.cli.arguments import add_json, add_run
from nodegraph.cli.output import refuse_existing, refuse_unwritable, say, write_file

HELP = "Print methods, settings and BibTeX of a run for a paper."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_run(parser)
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="Folder to write files to, with LaTeX as well."
    )
    add_json(parser)


def cite(arguments: Namespace) -> int:
    """Print the texts for a paper, or write them as Markdown, LaTeX and BibTeX."""
    from nodegraph.cli.answers import CiteAnswer, print_json
    from nodegraph.report.paper_texts import cited
    from nodegraph.report.study import read_study

    study = read_study(arguments.run)
    texts = cited(study)
    if arguments.json:
        print_json(CiteAnswer(texts, [str(method) for method in study.without_result]))
    elif arguments.out is None:
        print("\n".join(texts[name] for name in texts if not name.endswith(".tex")).rstrip())
    else:
        paths = {arguments.out / name: text for name, text in texts.items()}
        for path in paths:  # all of them are written, or none
            refuse_existing(path)
            refuse_unwritable(path)
        for path, text in paths.items():
            write_file(path, text.encode(errors="backslashreplace"))
            print(path)
    for method in study.without_result:
        say(f"not cited, because it gave no result: {method}")
    return 0
