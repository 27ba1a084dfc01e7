"""``nodegraph live``: run what a stream can feed of a graph, frame by frame."""

from __future__ import annotations

import json
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_graph, add_store
from nodegraph.cli.output import columns, say, write_file
from nodegraph.errors import NodegraphError

if TYPE_CHECKING:
    from nodegraph.live.counts import Counts
    from nodegraph.live.plan import LivePlan
    from nodegraph.live.session import Session
    from nodegraph.serve.stream import StreamPage

HELP = "Run a graph on a stream, frame by frame."
RECORD = "live.json"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_graph(parser)
    parser.add_argument(
        "--source",
        required=True,
        metavar="NAME=ADDRESS",
        help="Stream in place of a node without inputs, or of the input or axis that chooses what "
        "it reads: --source recording=replay:take.c3d@240.",
    )
    parser.add_argument(
        "--sink",
        action="append",
        default=[],
        metavar="NODE=ADDRESS",
        help="Where the frames of a node go: --sink fill=file:filled.npz. Of alternatives side "
        "by side, the address has the label: --sink 'fill=file:{fill}.npz'.",
    )
    add_hold(parser)
    parser.add_argument(
        "--policy",
        choices=("every", "newest"),
        default="every",
        help="What to do if frames arrive faster than they are computed: compute every one, or "
        "drop all but the newest (default: %(default)s).",
    )
    parser.add_argument(
        "--record",
        type=Path,
        metavar="FILE",
        help="File for the received packets, which replay:FILE plays.",
    )
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help=f"Folder for the counts, as {RECORD}."
    )
    parser.add_argument(
        "--open",
        action="store_true",
        help="Show the stream on a page in a browser while it runs, and how it has ended.",
    )
    parser.add_argument("--json", action="store_true", help="Print the counts as JSON.")
    add_store(parser)


def add_hold(parser: ArgumentParser) -> None:
    """Add ``--hold NODE``."""
    parser.add_argument(
        "--hold",
        action="append",
        default=[],
        metavar="NODE",
        help="Compute this node once, before the stream begins, from what the graph itself reads.",
    )


def live(arguments: Namespace) -> int:
    """Run a graph on a stream until it ends or is interrupted, and print what was counted."""
    from nodegraph.cli.browser import show
    from nodegraph.cli.graphs import graph_of, store_of
    from nodegraph.live.session import session_of

    graph = graph_of(arguments)
    session = session_of(
        graph,
        _pair("source", arguments.source),
        [_pair("sink", text) for text in arguments.sink],
        hold=arguments.hold,
        policy=arguments.policy,
        record=arguments.record,
        store=store_of(arguments, graph),
        announce=say,
    )
    for line in lines_on(session.plan):
        say(line)
    with ExitStack() as ending:
        page = None
        if arguments.open:
            page = ending.enter_context(_page_of(session, graph.title, arguments))
            say(f"{page.address}\nopen this address in one browser")
            show(page.address)
        error = None
        try:
            session.run()
        except NodegraphError as failure:
            if not session.counts.received:
                raise
            error = failure
        content = json.dumps(
            {
                "graph": graph.title,
                "source": arguments.source,
                "sinks": arguments.sink,
                "policy": arguments.policy,
                "behind": {live.step.name: live.behind for live in session.plan.steps},
                "cut_off": dict(session.plan.cut_off),
                "error": error and str(error),
                **session.counts.as_json(),
            },
            indent=2,
        )
        print(content if arguments.json else "\n".join(_summary(session.counts)))
        if arguments.out:
            write_file(arguments.out / RECORD, content.encode())
        if error:
            raise error
        if page is not None and not session.is_stopped:
            page.end()
            say("the stream has ended; Ctrl-C ends its page")
            with suppress(KeyboardInterrupt):
                Event().wait()
    return 0


def _page_of(session: Session, title: str, arguments: Namespace) -> StreamPage:
    """Return a page that shows a session."""
    from nodegraph.cli.browser import needing_pages

    with needing_pages():
        from nodegraph.serve.stream import StreamPage
    facts = (Path(arguments.graph).name, arguments.source, f"policy {arguments.policy}")
    return StreamPage(session, title, facts, say)


def lines_on(plan: LivePlan) -> Iterator[str]:
    """Yield which nodes do not run on the stream, and which differ there from the whole take."""
    from nodegraph.node.description import describe_departure

    cut_off: dict[str, list[str]] = {}
    for node, reason in plan.cut_off.items():
        cut_off.setdefault(reason, []).append(node)
    departures: dict[str, list[str]] = {}
    for live in plan.steps:
        if departure := describe_departure(live.step.method.node):
            departures.setdefault(departure, []).append(live.step.name)
    for reason, nodes in cut_off.items():
        yield f"not on the stream: {', '.join(nodes)}: {reason}"
    for departure, steps in departures.items():
        yield f"on a stream, {', '.join(steps)}: {departure}"


def _summary(counts: Counts) -> Iterator[str]:
    from nodegraph.live.counts import NUMBERS

    numbers = {name: getattr(counts, name) for name in NUMBERS}
    shown = {name: count for name, count in numbers.items() if count}
    yield f"frames: {', '.join(f'{count} {name}' for name, count in shown.items()) or 'none'}"
    for sink in {**counts.written, **counts.unsent}:
        unsent = counts.unsent[sink]
        yield f"{sink}: {counts.written[sink]} frames" + (f", {unsent} unsent" if unsent else "")
    for what, causes in (("refused", counts.refused), ("warned", counts.warnings)):
        for text, count in causes:
            yield f"{what}{f' {count} times' * (count > 1)}: {text}"
    by_columns: dict[tuple[str, ...], list[tuple[str, ...]]] = {}
    for name, latest in counts.running.items():
        current = latest.as_json().values()
        texts = ("-" if number is None else f"{number:.4g}" for number in current)
        by_columns.setdefault(tuple(latest.header.columns), []).append((name, *texts))
    for head, rows in by_columns.items():
        yield columns([("after the last frame", *head), *rows])
    milliseconds = counts.latencies.milliseconds()
    if milliseconds:
        head = tuple(milliseconds)
        row = tuple(f"{value:.3f}" for value in milliseconds.values())
        yield columns([("latency in ms", *head), ("", *row)])


def _pair(option: str, text: str) -> tuple[str, str]:
    name, equals, address = text.partition("=")
    if not equals or not name or not address:
        raise NodegraphError(f"--{option} {text}: write --{option} NAME=ADDRESS")
    return name, address
