"""What each command takes: its words, options and their help."""

from __future__ import annotations

import argparse
from importlib import metadata
from pathlib import Path
from typing import Any


def parser() -> argparse.ArgumentParser:
    """Return what reads the words of a command line."""
    read = argparse.ArgumentParser(
        prog="nodegraph",
        description="Compare methods that process facial motion capture.",
        allow_abbrev=False,
    )
    text = "tell which version this is, and leave"
    read.add_argument("--version", action=_Version, nargs=0, default=argparse.SUPPRESS, help=text)
    commands = read.add_subparsers(dest="command", required=True, metavar="COMMAND")
    _add_run(commands)
    _add_check(commands)
    _add_draw(commands)
    _add_nodes(commands)
    _add_show(commands)
    _add_examples(commands)
    _add_new(commands)
    _add_why(commands)
    _add_diff(commands)
    _add_lock(commands)
    _add_verify(commands)
    _add_audit(commands)
    _add_export(commands)
    _add_report(commands)
    _add_cite(commands)
    _add_archive(commands)
    _add_cache(commands)
    _add_schema(commands)
    return read


class _Version(argparse.Action):
    """Print the version: it is looked up only if somebody asks."""

    def __call__(self, read: argparse.ArgumentParser, *rest: Any) -> None:
        print(f"nodegraph {metadata.version('nodegraph')}")
        read.exit()


def _add_run(commands: Any) -> None:
    run = _add(commands, "run", "check, plan and run a graph; write the report")
    _add_graph(run)
    run.add_argument("--out", type=Path, metavar="DIR", help="where to write (runs/NAME)")
    _add_how(run)
    run.add_argument("--until", action="append", default=[], metavar="NODE", help="run no further")
    run.add_argument("--no-cache", action="store_true", help="neither use nor keep stored results")
    _add_store(run)


def _add_check(commands: Any) -> None:
    check = _add(commands, "check", "tell all mistakes of a graph, or what it would do")
    _add_graph(check)
    _add_store(check)


def _add_draw(commands: Any) -> None:
    draw = _add(commands, "draw", "draw a graph")
    _add_graph(draw)
    draw.add_argument("--format", choices=("svg", "mermaid", "dot"), help="(from --out, else svg)")
    draw.add_argument("--out", type=Path, metavar="FILE", help="where to write (standard output)")


def _add_nodes(commands: Any) -> None:
    nodes = _add(commands, "nodes", "list the installed nodes")
    nodes.add_argument("family", nargs="?", metavar="FAMILY", help="such as fill")
    _add_plugin(nodes)


def _add_show(commands: Any) -> None:
    show = _add(commands, "show", "show one node: ports, settings, units, citation")
    show.add_argument("node", metavar="NODE", help="such as fill.muscle")
    _add_plugin(show)


def _add_examples(commands: Any) -> None:
    examples = _add(commands, "examples", "list the example graphs, or copy some of them here")
    examples.add_argument("names", nargs="*", metavar="NAME", help="graphs to copy")
    examples.add_argument("--to", type=Path, default=Path(), metavar="DIR", help="where to")
    _add_plugin(examples)


def _add_new(commands: Any) -> None:
    new = _add(commands, "new", "write a plugin package, or a graph, that works")
    new.add_argument("kind", metavar="KIND", help="plugin or graph")
    new.add_argument(
        "name", metavar="NAME", help="a plugin's is its package's too, a graph's its file's"
    )
    new.add_argument("--to", type=Path, default=Path(), metavar="DIR", help="where to")
    _add_plugin(new)


def _add_why(commands: Any) -> None:
    why = _add(commands, "why", "tell why a node would run again")
    _add_graph(why)
    why.add_argument("node", metavar="NODE", help="a node of the graph")
    why.add_argument("--run", type=Path, metavar="DIR", help="the earlier run (runs/NAME)")
    _add_store(why)


def _add_diff(commands: Any) -> None:
    diff = _add(commands, "diff", "tell where two runs differ first, and why; status 1 if they do")
    diff.add_argument("run", type=Path, metavar="RUN", help="the folder of a run: runs/NAME")
    diff.add_argument("other", type=Path, metavar="RUN", help="the folder of another run")
    _add_plugin(diff)
    _add_store(diff)


def _add_lock(commands: Any) -> None:
    text = "freeze a study: write what decides its results, and what they are"
    lock = _add(commands, "lock", text)
    _add_graph(lock)
    lock.add_argument("--out", type=Path, metavar="FILE", help="where to write (GRAPH.lock)")
    _add_how(lock)
    _add_store(lock)


def _add_verify(commands: Any) -> None:
    text = (
        "tell whether a frozen study still gives its results: identical, within tolerance, same "
        "conclusions (status 0), or diverged (status 1, as whenever conclusions changed)"
    )
    verify = _add(commands, "verify", text)
    verify.add_argument("lock", type=Path, metavar="LOCK", help="written by nodegraph lock")
    verify.add_argument("--rerun", action="store_true", help="use no stored result")
    where = "where a file lies here that the lock knows by name only"
    verify.add_argument("--set", action="append", default=[], metavar="INPUT=VALUE", help=where)
    _add_plugin(verify)
    _add_how(verify)
    _add_store(verify)


def _add_audit(commands: Any) -> None:
    text = (
        "repeat the steps of a graph: does each method give one answer, with more threads and in "
        "another process too? status 1 if one does not"
    )
    audit = _add(commands, "audit", text)
    _add_graph(audit)
    audit.add_argument(
        "--all", action="store_true", help="every combination, not one of each method"
    )
    _add_how(audit)
    # a node that ends its process ends nothing else then
    audit.set_defaults(executor="processes")
    _add_store(audit)


def _add_export(commands: Any) -> None:
    export = _add(commands, "export", "write a value of a run as a file")
    export.add_argument("run", type=Path, metavar="RUN", help="the folder of a run: runs/NAME")
    export.add_argument("node", metavar="NODE", help="a node, or one of its outputs: gaps.truth")
    export.add_argument(
        "--at", action="append", default=[], metavar="AXIS=LABEL", help="which one: fill=muscle"
    )
    export.add_argument(
        "--out", type=Path, required=True, metavar="FILE", help="its suffix says in which form"
    )
    _add_plugin(export)
    _add_store(export)


def _add_report(commands: Any) -> None:
    text = "make the report of a run again, or lay several runs side by side"
    report = _add(commands, "report", text)
    report.add_argument("runs", nargs="+", type=Path, metavar="RUN", help="runs/NAME")
    report.add_argument("--out", type=Path, metavar="FILE", help="(report.html in the run)")


def _add_cite(commands: Any) -> None:
    cite = _add(commands, "cite", "print methods, settings and BibTeX of a run for a paper")
    cite.add_argument("run", type=Path, metavar="RUN", help="the folder of a run: runs/NAME")
    cite.add_argument("--out", type=Path, metavar="DIR", help="write files, LaTeX too")


def _add_archive(commands: Any) -> None:
    text = "put a run into one file: graph, inputs, results, sources; a Workflow Run RO-Crate"
    archive = _add(commands, "archive", text)
    archive.add_argument("run", type=Path, metavar="RUN", help="the folder of a run: runs/NAME")
    archive.add_argument("--out", type=Path, metavar="FILE", help="where to write (RUN.zip)")
    archive.add_argument(
        "--lock", type=Path, metavar="FILE", help="goes in too (GRAPH.lock, if it is there)"
    )
    archive.add_argument(
        "--no-inputs",
        action="store_false",
        dest="inputs",
        help="only the SHA-256 of the files that the run read, not the files",
    )


def _add_cache(commands: Any) -> None:
    cache = _add(commands, "cache", "list, prune or clear stored results")
    cache.add_argument(
        "action", nargs="?", default="size", choices=("size", "list", "prune", "clear")
    )
    cache.add_argument(
        "--older", default="", metavar="AGE", help="prune what was last used so long ago: 30d, 12h"
    )
    cache.add_argument(
        "--keep", default="", metavar="SIZE", help="prune the longest unused down to: 10GB"
    )
    _add_store(cache)


def _add_schema(commands: Any) -> None:
    schema = _add(commands, "schema", "print a JSON Schema of graph files, for editors")
    schema.add_argument("--out", type=Path, metavar="FILE", help="where to write (standard output)")
    _add_plugin(schema)


def _add_how(command: argparse.ArgumentParser) -> None:
    text = "steps at a time (one per processor)"
    command.add_argument("--jobs", type=int, metavar="N", help=text)
    names = "threads, serial, processes, dask, or a plugin's"
    command.add_argument("--executor", default="threads", metavar="NAME", help=names)
    command.add_argument("--scheduler", default="", metavar="ADDRESS", help="of a Dask cluster")


def _add_store(command: argparse.ArgumentParser) -> None:
    text = "where stored results lie (NODEGRAPH_STORE, else the platform's cache folder)"
    command.add_argument("--store", type=Path, metavar="DIR", help=text)


def _add(commands: Any, name: str, text: str) -> argparse.ArgumentParser:
    made: argparse.ArgumentParser = commands.add_parser(
        name, help=text, description=f"{text[0].upper()}{text[1:]}.", allow_abbrev=False
    )
    return made


def _add_graph(command: argparse.ArgumentParser) -> None:
    command.add_argument("graph", type=Path, metavar="GRAPH", help="a graph file")
    command.add_argument("--set", action="append", default=[], metavar="INPUT=VALUE")
    command.add_argument("--axis", action="append", default=[], metavar="AXIS=LABELS")
    command.add_argument("--only", action="append", default=[], metavar="AXIS=LABELS")
    _add_plugin(command)


def _add_plugin(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--plugin", action="append", default=[], type=Path, metavar="FILE", help="a file with nodes"
    )
