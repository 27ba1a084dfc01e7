"""``nodegraph export``."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from nodegraph.cli.common import labels_of, say, written
from nodegraph.errors import NodegraphError, Refusal
from nodegraph.formatting import size_text


def export(arguments: Namespace) -> int:
    """Write one value of a finished run as a file, in the form that its suffix names."""
    from nodegraph.execute import open_store
    from nodegraph.plugin.registry import Registry
    from nodegraph.runs.saved_run import FinishedRun

    _check_free(arguments.out)
    run = FinishedRun(arguments.run)
    registry = Registry.installed(arguments.plugin)
    store = open_store(registry, arguments.store, say)
    value = run.value(arguments.node, labels_of("at", arguments.at), store)
    for path, content in _files(value, arguments.out, registry).items():
        _write(path, content)
        print(f"{path} ({size_text(len(content))})")
    return 0


def _files(value: Any, out: Path, registry: Any) -> Mapping[Path, bytes]:
    """Return the content of each file; the one asked for first, others beside it."""
    from nodegraph.runs.export import forms_of

    forms = forms_of(value, registry)
    kind = type(value).__name__
    if out.suffix.lower() not in forms:
        there = ", ".join(sorted(forms)) or "no form at all"
        raise NodegraphError(f"{out}: a value of type {kind} can be written as {there}")
    try:
        made = forms[out.suffix.lower()]()
    except Exception as error:  # whatever a stranger's writer raises
        told = "" if isinstance(error, (ValueError, Refusal)) else f"{type(error).__name__}: "
        raise NodegraphError(f"{out}: {told}{error}") from error
    names = [out, *(out.parent / name for name in list(made)[1:])]
    return dict(zip(names, made.values(), strict=True))


def _check_free(path: Path) -> None:
    if path.exists():
        raise NodegraphError(f"{path} is there already; name another file, or remove it first")


def _write(path: Path, content: bytes) -> None:
    _check_free(path)
    written(path, content)
