"""``nodegraph run``."""

from __future__ import annotations

from argparse import Namespace

from nodegraph.cli.common import command_of, graph_of, left_out_lines, run_folder, say, store_of
from nodegraph.cli.progress import progress


def run(arguments: Namespace) -> int:
    """Check, plan and run a graph; write the report; print its tables."""
    from nodegraph.api import reported
    from nodegraph.execute import HowToRun, execute, executor_of
    from nodegraph.plan import plan
    from nodegraph.report.files import report_files, summary
    from nodegraph.runs.folder import RunFolder
    from nodegraph.runs.record import record

    graph, command = graph_of(arguments), command_of(arguments)
    graph = graph.until(arguments.until) if arguments.until else graph
    how = HowToRun(arguments.executor, arguments.jobs, arguments.scheduler)
    executor_of(how, graph.registry.hooks.executors)
    folder = RunFolder(arguments.out or run_folder(arguments), graph.spec.text, graph.spec.included)
    for line in left_out_lines(graph):
        say(line)
    try:
        with progress() as shown:
            done = execute(
                plan(graph),
                how=how,
                store=None if arguments.no_cache else store_of(arguments, graph, shown.say),
                keep=reported(graph),
                listeners=[shown.hear, folder.hear],
            )
    except Exception:
        folder.abandon()
        raise
    except KeyboardInterrupt:
        if not arguments.no_cache:
            say("what is done is stored: the same command goes on from there")
        raise
    if folder.moved:
        say(f"the earlier run is now in {folder.moved}")
    files, study = report_files(done, command=command)
    folder.finish(files, record(done, command))
    print(f"{summary(study, done)}\n\n{folder.path / 'report.html'}")
    return 0 if study.ok else 1
