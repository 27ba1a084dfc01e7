"""``nodegraph run``."""

from __future__ import annotations

import sys
from argparse import Namespace
from pathlib import Path

from nodegraph.commands.chosen import command_of, graph_of
from nodegraph.terminal import progress


def run(arguments: Namespace) -> int:
    """Check, plan and run a graph; write the report; print its tables."""
    from nodegraph.api import reported
    from nodegraph.execute import HowToRun, execute, executor_of
    from nodegraph.execute.record import record
    from nodegraph.folder import RunFolder
    from nodegraph.plan import plan
    from nodegraph.report.write import report_files, summary

    graph, command = graph_of(arguments), command_of(arguments)
    how = HowToRun(arguments.executor, arguments.jobs)
    executor_of(how, graph.registry.executors)
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
