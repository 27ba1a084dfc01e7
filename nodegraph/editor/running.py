"""The run of the graph file that is edited: what it would compute, its start and its end."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from io import BytesIO
from itertools import takewhile
from pathlib import Path
from threading import Thread
from typing import IO, Any

from nodegraph.errors import NodegraphError, Problems, listed
from nodegraph.execute.events import plain
from nodegraph.execute.preflight import check_files_and_settings
from nodegraph.execute.processes import kill
from nodegraph.execute.resume import StoredSteps, open_store
from nodegraph.graph import Graph
from nodegraph.graph.option_text import labels_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry
from nodegraph.report.from_run import first_answer
from nodegraph.runs.folder import EVENTS
from nodegraph.runs.record_files import read_record
from nodegraph.runs.state import RunState
from nodegraph.runs.why import Why, together
from nodegraph.serve.progress import NodeState
from nodegraph.serve.runs import ABSENT, OpenRun, OpenRuns, version_of

_PATIENCE = 20
"""Seconds in which a run ends that is interrupted; on Linux it does so after ten at most."""

_MOST_SAID = 10_000
"""Bytes of what the command has said last."""


class Running:
    """Runs a graph file in a process of its own, as ``nodegraph run`` does.

    Parameters
    ----------
    graph
        As the user named it.
    folder
        The folder of the run.
    registry
    store
        Folder of stored results; None for the default.
    plugins
        Files with further nodes.

    Attributes
    ----------
    store : Path or None
    runs : OpenRuns
        That run, and those beside it.
    """

    def __init__(
        self,
        graph: Path,
        folder: Path,
        registry: Registry,
        store: Path | None,
        plugins: Sequence[Path],
    ) -> None:
        self._folder = folder
        self._events = folder / EVENTS
        self.store = store
        self.runs = OpenRuns([folder.parent], registry, store)
        self._file = str(graph)
        self._words = [sys.executable, "-P", "-m", "nodegraph.cli.main"]
        self._words += ["run", "--quiet", "--out", str(folder)]
        self._words += [word for plugin in plugins for word in ("--plugin", str(plugin))]
        self._words += ["--store", str(store)] if store is not None else []
        self._number = 0
        self._text = ""
        self._process: subprocess.Popen[bytes] | None = None
        self._output: IO[bytes] = BytesIO()
        self._before = ABSENT
        self._only: Mapping[str, str] = {}
        self._reported: Sequence[str] = ()
        self._ended = 0
        self._answer = ""

    def preview(self, graph: Graph) -> Mapping[str, object]:
        """Return what a run would compute, and why that is not stored.

        Raises
        ------
        GraphError
            If a file cannot be read, or a setting does not fit what is in it.
        """
        planned = plan(graph)
        cache = StoredSteps(planned, open_store(graph.registry, self.store, lambda message: None))
        problems = Problems()
        warnings = check_files_and_settings(planned, cache, problems)
        problems.raise_any()
        missing = [step.index for step in planned.steps if step.index not in cache.known]
        try:
            why = Why(planned, cache, read_record(self._folder))
            changes = together(map(why.explain_step, missing))
        except NodegraphError:
            changes = []
        rows = []
        for node in graph.nodes:
            steps = set(planned.cells[node].values())
            rows.append([node, len(steps), len(steps.intersection(missing))])
        left_out = graph.left_out_together().items()
        return {
            "axes": [[name, [*map(str, axis.labels)]] for name, axis in graph.axes.items()],
            "nodes": rows,
            "steps": len(planned.steps),
            "missing": len(missing),
            "changes": changes,
            "warnings": [
                *map(str, warnings),
                *(f"left out: {listed(nodes, 5)}: {reason}" for reason, nodes in left_out),
            ],
        }

    def start(self, text: str, graph: Graph) -> None:
        """Begin a run of the file, which has this text and is this graph.

        Raises
        ------
        NodegraphError
            If the last one has not ended.
        """
        if self._is_going:
            raise NodegraphError("a run goes on; stop it first")
        self._before = version_of(self._events)
        self._text = text
        self._only = {
            axis: labels_text(plain(labels)) for axis, labels in graph.choices.only.items()
        }
        self._reported = [node for node, _ in graph.reported]
        self._ended, self._answer = 0, ""
        self._number += 1
        only = [word for each in self._only.items() for word in ("--only", "=".join(each))]
        self._output.close()
        self._output = tempfile.TemporaryFile()  # noqa: SIM115, as `end` closes it
        self._process = subprocess.Popen(
            [*self._words, *only, "--", self._file],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=self._output,
            process_group=0,  # else Ctrl-C in the terminal would interrupt it twice
        )

    def stop(self) -> None:
        """Interrupt the run, as Ctrl-C does; it can be continued."""
        if self._process is not None and self._is_going:
            if sys.platform == "win32":  # which has no such signal
                kill(self._process)
            else:
                self._process.send_signal(signal.SIGINT)

    def end(self) -> None:
        """Interrupt the run, and wait until it has ended."""
        if self._process is None:
            return
        self.stop()
        try:
            self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            kill(self._process)
            self._process.wait()
        self._output.close()

    def shown(self, text: str) -> Mapping[str, object] | None:
        """Return which run it is, and whether it is of this text; None before the first."""
        if not self._number:
            return None
        return {"number": self._number, "is_current": text == self._text}

    def snapshot(self) -> dict[str, Any]:
        """Return how far the run is as plain data: `OpenRun.snapshot`, and how it has ended."""
        is_over = not self._is_going
        run = self._run()
        data: dict[str, Any] = {
            "run": self._folder.name,
            "only": "; ".join(f"{axis} {labels}" for axis, labels in self._only.items()),
            "is_over": is_over,
            "state": "not begun" if is_over else "starting",
            "nodes": {},
            "alternatives": {},
            "seconds": 0.0,
            "to_go": None,
            "failures": [],
            "message": "",
            "answer": "",
            "has_report": False,
            "said": self._last_words() if is_over else "",
        }
        if run is None:
            return data
        if not is_over:
            begun = run.snapshot()
            if not begun["nodes"]:
                return data
            return data | begun | {"answer": self._first_answer(run, begun["nodes"])}
        condition = run.condition()
        data |= run.snapshot(condition.state)
        data["message"] = condition.message
        if condition.state is RunState.FINISHED:
            data["has_report"] = True
            data["answer"] = run.study().first_answer
        return data

    @property
    def _is_going(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def _run(self) -> OpenRun | None:
        """Return the run, once its folder has something of it."""
        if version_of(self._events) in (ABSENT, self._before):
            return None
        return self.runs.all().get(self._folder.name)

    def _first_answer(self, run: OpenRun, nodes: Mapping[str, NodeState]) -> str:
        """Return what the run answers so far, looked up when one more reported node has ended.

        That may take longer than a look at how far the run is.
        """
        ended = takewhile(
            lambda node: node not in nodes or nodes[node]["settled"] == 1, self._reported
        )
        count = len([*ended])
        if count > self._ended and not self._answer:
            self._ended = count
            Thread(target=self._look_up_answer, args=(run, self._number), daemon=True).start()
        return self._answer

    def _look_up_answer(self, run: OpenRun, number: int) -> None:
        with suppress(NodegraphError):  # the report says it
            answer = first_answer(run.values()[0])
            if number == self._number:
                self._answer = answer

    def _last_words(self) -> str:
        """Return what the command said last."""
        self._output.seek(0, os.SEEK_END)
        self._output.seek(max(0, self._output.tell() - _MOST_SAID))
        return self._output.read().decode(errors="replace").strip()
