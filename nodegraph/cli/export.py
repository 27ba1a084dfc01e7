"""``nodegraph export``: write a value of a run as a file."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_pairs, add_plugin, add_run, add_store, labels_at
from nodegraph.cli.output import refuse_existing, say, write_and_print
from nodegraph.errors import NodegraphError, Refusal, message_of

if TYPE_CHECKING:
    from nodegraph.plugin.registry import Registry

HELP = "Write a value of a run as a file."

_LAYOUT = {
    "rows": "Of a table in LaTeX: what stands down the side, such as fill or ends,fill.",
    "columns": "Of a table in LaTeX: what stands along the top, such as ends,length.",
}


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_run(parser)
    parser.add_argument(
        "node", metavar="NODE", help="Node, or one of its outputs, such as gaps.truth."
    )
    add_pairs(parser, "at", "Labels of the value: fill=muscle,trial=3.")
    for option, text in _LAYOUT.items():
        parser.add_argument(f"--{option}", metavar="LABELS", help=text)
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="FILE",
        help="File to write; its suffix is the format.",
    )
    add_plugin(parser)
    add_store(parser)


def export(arguments: Namespace) -> int:
    """Write a value of a run as a file, in the format that the suffix names."""
    from nodegraph.execute.resume import open_store
    from nodegraph.plugin.registry import Registry
    from nodegraph.runs.record_files import read_record
    from nodegraph.runs.recorded_value import recorded_value

    refuse_existing(arguments.out)
    record = read_record(arguments.run)
    registry = Registry.installed(arguments.plugin)
    store = open_store(registry, arguments.store, say)
    value = recorded_value(record, arguments.node, labels_at(arguments), store)
    chosen = {name: getattr(arguments, name) for name in _LAYOUT}
    layout = {name: tuple(text.split(",")) for name, text in chosen.items() if text}
    files = _files(value, arguments.out, registry, layout)
    for path in files:
        refuse_existing(path)
    for path, content in files.items():
        write_and_print(path, content)
    return 0


def _files(
    value: object, out: Path, registry: Registry, layout: Mapping[str, Sequence[str]]
) -> Mapping[Path, bytes]:
    """Return the content of each file: of `out` first, then of those beside it."""
    from nodegraph.filenames import fold, portable_name, portable_paths
    from nodegraph.runs.export import exporters_of

    exporters = exporters_of(value, registry, layout)
    kind = type(value).__name__
    if out.suffix.lower() not in exporters:
        formats = ", ".join(sorted(exporters)) or "no format"
        options = f" with {' and '.join(f'--{name}' for name in layout)}" if layout else ""
        raise NodegraphError(f"{out}: a value of type {kind} can be written as {formats}{options}")
    try:
        files = exporters[out.suffix.lower()]()
    except Exception as error:  # a plugin's writer may raise anything
        is_message = isinstance(error, (ValueError, Refusal))
        raise NodegraphError(
            f"{out}: {'' if is_message else f'{type(error).__name__}: '}{message_of(error)}"
        ) from error
    first, *rest = files
    names = portable_paths(rest)
    for name, path in names.items():
        if fold(path) == fold(out.name):
            names[name] = portable_name(name, digest=True)
    return {out: files[first], **{out.parent / names[name]: files[name] for name in rest}}
