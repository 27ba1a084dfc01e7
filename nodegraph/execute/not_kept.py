"""What a run could not store: how many results, for each reason."""

from __future__ import annotations

from nodegraph.execute.results import Run


def not_kept_lines(run: Run) -> list[str]:
    """Return what a terminal says of it: ``2 results are not stored: why``."""
    if run.recall is None:
        return []
    return [
        f"{count} results are not stored: {reason}" for reason, count in run.recall.not_kept.items()
    ]
