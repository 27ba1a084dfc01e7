"""``nodegraph show``: list the installed nodes, describe a node, or say what is in a file."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_json, add_plugin, add_reading, values_of
from nodegraph.cli.output import columns
from nodegraph.errors import NodegraphError, nearest

if TYPE_CHECKING:
    from nodegraph.plugin.registry import Registered, Registry

HELP = (
    "List the installed nodes, show a node (ports, settings, units, citation), or say what is in a "
    "file: its size, rate, what is missing, and what reading it had to guess."
)


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "word",
        nargs="?",
        default="",
        metavar="WORD",
        help="Node, such as fill.muscle; or family, such as fill, or part of a name or summary, to "
        "list the nodes; or file, such as take.c3d.",
    )
    add_reading(parser)
    add_plugin(parser)
    add_json(parser)


def show(arguments: Namespace) -> int:
    """Print the description of a node or a file, or the list of nodes to which a word applies."""
    from nodegraph.plugin.registry import Registry

    registry = Registry.installed(arguments.plugin)
    if _names_file(arguments.word, registry):
        _print_file(arguments, registry)
        return 0
    if getattr(arguments, "with"):
        raise NodegraphError(f"--with sets what a file does not state; {arguments.word!r} is none")
    is_node = "." in arguments.word and not arguments.word.endswith(".*")
    if arguments.json:
        _print_json(arguments.word, registry, is_node=is_node)
        return 0
    print(_description(arguments.word, registry) if is_node else _list(arguments.word, registry))
    return 0


def _names_file(word: str, registry: Registry) -> bool:
    """Return whether a word, by its form or because it is there, names a file and no node."""
    name = word.removesuffix(".*")
    nodes = {name for each in registry for name in (each.node.name, each.full_name)}
    if not word or name in (*registry.families, *nodes):
        return False
    path = Path(word)
    suffixes = {suffix for each in registry.hooks.formats for suffix in each.suffixes}
    has_form = len(path.parts) > 1 or path.suffix.lower() in suffixes
    return has_form or path.exists() or registry.hooks.is_place(word)


def _print_file(arguments: Namespace, registry: Registry) -> None:
    from nodegraph.execute.read_files import read_files
    from nodegraph.runs.folder import is_run

    if is_run(Path(arguments.word)):
        raise NodegraphError(
            f"{arguments.word} is a run; `nodegraph open {arguments.word}` shows its report"
        )
    (file,) = read_files([arguments.word], registry, values_of(arguments, "with"))
    if arguments.json:
        from nodegraph.cli.answers import FileAnswer, ShownFact, print_json

        facts = [ShownFact(fact.name, fact.value, fact.unit) for fact in file.facts]
        print_json(FileAnswer(file.path, file.format, file.node, facts, file.warnings))
        return
    print(f"{file.path}    {file.format}, read by {file.node}\n")
    print(columns([(fact.name, fact.text) for fact in file.facts if not fact.table]))
    for fact in file.facts:
        if fact.table:
            print(f"\n{fact.name}\n{columns(fact.table)}")
    if file.warnings:
        print("\n".join(["", "guessed or left out", *(f"- {text}" for text in file.warnings)]))


def _print_json(word: str, registry: Registry, *, is_node: bool) -> None:
    from nodegraph.cli.answers import ListedNode, ShowAnswer, ShownPort, print_json
    from nodegraph.node.description import describe_declaration, describe_settings, summary_of
    from nodegraph.plugin.bibliography import references

    entries = [registry.find(word)] if is_node else _matches(word, registry)
    listed = [
        ListedNode(each.node.name, each.plugin, each.distribution, summary_of(each.node))
        for each in entries
    ]
    if not is_node:
        print_json(ShowAnswer(listed))
        return
    node = entries[0].node
    inputs, outputs = (
        [
            ShownPort(port.name, port.type.__name__, port.optional, port.across, port.truth)
            for port in ports
        ]
        for ports in (node.inputs, node.outputs)
    )
    cites = list(references(registry.hooks.of("bibtex"), node.cite).values())
    settings, declared = describe_settings(node), describe_declaration(node)
    print_json(ShowAnswer(listed, inputs, outputs, settings, declared, node.doc, cites))


def _list(word: str, registry: Registry) -> str:
    from nodegraph.node.description import plain_summary_of

    entries = _matches(word, registry)
    return columns([(each.node.name, plain_summary_of(each.node), each.plugin) for each in entries])


def _matches(word: str, registry: Registry) -> list[Registered]:
    """Return the nodes of a family, or those with a word in their name or summary."""
    from nodegraph.node.description import summary_of

    word = word.removesuffix(".*").lower()
    entries = list(registry)
    family = [each for each in entries if each.node.name.startswith(f"{word}.")]
    matches = family or [
        each for each in entries if word in f"{each.node.name} {summary_of(each.node)}".lower()
    ]
    if word and not matches:
        hint = nearest(word, registry.families)
        raise NodegraphError(f"no node has {word!r} in its name or summary; {hint}")
    return matches


def _description(name: str, registry: Registry) -> str:
    from nodegraph.node.description import (
        describe_declaration,
        describe_settings,
        has_example,
        without_parameters,
    )
    from nodegraph.plugin.bibliography import references

    entry = registry.find(name)
    node = entry.node
    parts = [f"{node.name}    plugin {entry.plugin} {entry.distribution}".rstrip()]
    if node.deprecated:
        parts.append(f"deprecated: {node.deprecated}")
    ports = [("in", str(port)) for port in node.inputs]
    parts.append(columns([*ports, *(("out", str(port)) for port in node.outputs)]))
    settings = describe_settings(node)
    if settings:
        head = ("setting", "default", "unit", "is", "meaning")
        rows = [(row.name, row.default_text, row.unit, row.kind, row.meaning) for row in settings]
        parts.append(columns([head, *rows]))
    if declared := describe_declaration(node):
        parts.append("\n".join(declared))
    parts.append(without_parameters(node.doc))
    if not has_example(node):
        parts.append(_example(entry, registry))
    cited = references(registry.hooks.of("bibtex"), node.cite).values()
    parts.append("cite: " + ("\n      ".join(cited) or "nothing"))
    return "\n\n".join(parts)


def _example(entry: Registered, registry: Registry) -> str:
    from nodegraph.node.description import example_of

    is_unique = sum(other.node.name == entry.node.name for other in registry) == 1
    text = example_of(entry.node, "" if is_unique else entry.full_name)
    return "\n".join(
        ["example, among the nodes of a graph:", *(f"  {line}" for line in text.splitlines())]
    )
