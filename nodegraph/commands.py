"""What each command does."""

from __future__ import annotations

import shutil
import sys
from argparse import Namespace
from pathlib import Path
from typing import Any

from nodegraph.errors import GraphError, NodegraphError, nearest
from nodegraph.graph import Choices, Graph, build
from nodegraph.ports import Label
from nodegraph.registry import Registered, Registry
from nodegraph.spec import read_graph_file
from nodegraph.spec.yaml_text import read_yaml
from nodegraph.terminal import columns, progress


def run(arguments: Namespace) -> int:
    """Check, plan and run a graph; write the report; print its tables."""
    from nodegraph.api import reported
    from nodegraph.execute import HowToRun, execute
    from nodegraph.execute.record import record
    from nodegraph.folder import RunFolder
    from nodegraph.plan import plan
    from nodegraph.report.write import report_files, summary

    graph, command = _graph(arguments), _command(arguments)
    how = HowToRun(arguments.executor, arguments.jobs)
    how.chosen()
    folder = RunFolder(arguments.out or Path("runs") / arguments.graph.stem, graph.spec.text)
    for one in graph.left_out:
        print(f"left out: {one.node}: {one.reason}", file=sys.stderr)
    if folder.moved:
        print(f"the earlier run is now in {folder.moved}", file=sys.stderr)
    with progress() as listener:
        kept = reported(graph)
        done = execute(plan(graph), how=how, keep=kept, listeners=[listener, folder.hear])
    files, study = report_files(done, command=command)
    folder.finish(files, {"command": command, **record(done)})
    print(f"{summary(study, done.counts())}\n\n{folder.path / 'report.html'}")
    return 0 if done.ok else 1


def check(arguments: Namespace) -> int:
    """Print what a graph would do."""
    from nodegraph.plan import plan

    graph = _graph(arguments)
    made = plan(graph)
    rows = [("node", "uses", "along", "steps")]
    counts = {name: len(set(cells.values())) for name, cells in made.cells.items()}
    for node in graph.nodes.values():
        uses = ", ".join(method.node.name for method in node.methods.values())
        along = " x ".join(f"{axis} ({len(graph.axes[axis].labels)})" for axis in node.axes)
        rows.append((node.name, uses, along, str(counts[node.name])))
    print(f"{graph.title}\n\n{columns(rows)}\n\n{len(made.steps)} steps")
    for one in graph.left_out:
        print(f"left out: {one.node}: {one.reason}")
    skipped = sum(len(cells) for cells in made.skipped.values())
    if skipped:
        print(f"{skipped} combinations are skipped")
    return 0


def draw(arguments: Namespace) -> int:
    """Write a drawing of a graph."""
    from nodegraph import draw as drawing
    from nodegraph.draw.from_graph import picture_of

    by_suffix = {
        ".svg": "svg",
        ".mmd": "mermaid",
        ".mermaid": "mermaid",
        ".dot": "dot",
        ".gv": "dot",
    }
    suffix = arguments.out.suffix if arguments.out else ".svg"
    form = arguments.format or by_suffix.get(suffix)
    if form is None:
        raise NodegraphError(
            f"--out {arguments.out}: {nearest(suffix, by_suffix)}; or give --format"
        )
    text: str = getattr(drawing, form)(picture_of(_graph(arguments)))
    if arguments.out:
        arguments.out.write_text(text, encoding="utf-8")
    else:
        print(text)
    return 0


def nodes(arguments: Namespace) -> int:
    """List the installed nodes."""
    registry = Registry.installed(arguments.plugin)
    family = (arguments.family or "").removesuffix(".*")
    if family and not registry.family(family):
        raise NodegraphError(f"no family {family!r}; {nearest(family, registry.families)}")
    found = [one for one in registry if not family or one.node.family == family]
    print(columns([(one.node.name, one.node.summary, one.plugin) for one in found]))
    return 0


def show(arguments: Namespace) -> int:
    """Show one node."""
    registry = Registry.installed(arguments.plugin)
    print(_shown(registry.find(arguments.node), registry))
    return 0


def examples(arguments: Namespace) -> int:
    """List the example graphs, or copy some of them."""
    there = Registry.installed(arguments.plugin).graphs
    unknown = [name for name in arguments.names if name.removesuffix(".yaml") not in there]
    if unknown:
        raise NodegraphError(f"no example {unknown[0]!r}; {nearest(unknown[0], there)}")
    if not arguments.names:
        rows = [(name, read_graph_file(path).title) for name, path in there.items()]
        print(f"{columns(rows)}\n\nnodegraph examples NAME copies one here")
    for name in arguments.names:
        _copy(there[name.removesuffix(".yaml")], arguments.to)
    return 0


def _graph(arguments: Namespace) -> Graph:
    registry = Registry.installed(arguments.plugin)
    choices = Choices(
        inputs={name: _value(f"--set {name}", text) for name, text in _pairs(arguments, "set")},
        axes={name: _labels(f"--axis {name}", text) for name, text in _pairs(arguments, "axis")},
        only={name: _kept(f"--only {name}", text) for name, text in _pairs(arguments, "only")},
    )
    return build(read_graph_file(arguments.graph), registry, choices)


def _pairs(arguments: Namespace, option: str) -> list[tuple[str, str]]:
    pairs: list[tuple[str, str]] = []
    for word in getattr(arguments, option):
        name, equals, text = word.partition("=")
        if not equals or not name:
            raise NodegraphError(f"--{option} {word}: write --{option} NAME=VALUE")
        if name in dict(pairs):
            raise NodegraphError(f"--{option} {name} is given twice")
        pairs.append((name, text))
    return pairs


def _value(option: str, text: str) -> Any:
    try:
        return read_yaml(text, option).plain()
    except GraphError:
        return text  # a path may hold what YAML would read as its own marks


def _labels(option: str, text: str) -> Any:
    return read_yaml(text if text.startswith(("[", "{")) else f"[{text}]", option).plain()


def _kept(option: str, text: str) -> tuple[Label, ...]:
    found = _labels(option, text)
    return tuple(found)


def _command(arguments: Namespace) -> str:
    import shlex

    words = ["nodegraph", "run", str(arguments.graph)]
    for option in ("set", "axis", "only", "plugin"):
        for one in getattr(arguments, option):
            words += [f"--{option}", str(one)]
    return shlex.join(words)


def _shown(found: Registered, registry: Registry) -> str:
    from nodegraph.bibliography import references
    from nodegraph.describe import describe_settings, without_parameters

    node = found.node
    ports = [("in", str(port)) for port in node.inputs] + [
        ("out", str(port)) for port in node.outputs
    ]
    parts = [f"{node.name}    plugin {found.plugin} {found.distribution}".rstrip(), columns(ports)]
    settings = describe_settings(node)
    if settings:
        head = ("setting", "default", "unit", "is", "meaning")
        rows = [(one.name, one.default, one.unit, one.kind, one.meaning) for one in settings]
        parts.append(columns([head, *rows]))
    parts.append(without_parameters(node.doc))
    cited = references(registry.bibtex, node.cite).values()
    parts.append("cite: " + ("\n      ".join(cited) or "nothing"))
    return "\n\n".join(parts)


def _copy(path: Path, folder: Path) -> None:
    target = folder / path.name
    if target.exists():
        raise NodegraphError(f"{target} is there already; it is left as it is")
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(path, target)
    print(f"wrote {target}; run it with: nodegraph run {target}")
