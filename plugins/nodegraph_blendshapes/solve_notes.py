"""What a user must know of weights besides the weights."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_blendshapes.solve_problem import SEEN

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nodegraph_blendshapes.solve_frames import Solved
    from nodegraph_blendshapes.solve_problem import Problem


def notes_of(
    problem: Problem, solved: Solved, names: tuple[str, ...], *, smoothness: float
) -> list[str]:
    """Return a sentence, without its stop, for each thing that was left out or not found."""
    return [
        *problem.notes,
        *_hidden(solved, names, smoothness),
        *_empty(problem),
        *_unshared(solved),
        *_unsolved(solved),
    ]


def _hidden(solved: Solved, names: tuple[str, ...], smoothness: float) -> Iterator[str]:
    frames = int(np.count_nonzero(solved.unseen.any(axis=1)))
    if frames:
        instead = "follows from the frames around" if smoothness else "is 0"
        counts = solved.unseen.sum(axis=0)
        shapes = ", ".join(
            f"{name} ({count})" for name, count in zip(names, counts, strict=True) if count
        )
        yield (
            f"in {frames} of {len(solved.unseen)} frames the markers by which a shape moves "
            f"{SEEN:g} mm are missing; its weight there {instead}: {shapes}"
        )


def _empty(problem: Problem) -> Iterator[str]:
    empty = np.asarray(~problem.present.any(axis=1))
    if empty.any():
        yield (
            f"{np.count_nonzero(empty)} of {len(empty)} frames have none of the model's markers, "
            f"and no weights; the first is frame {empty.argmax()}"
        )


def _unshared(solved: Solved) -> Iterator[str]:
    if solved.unshared.any():
        yield (
            f"in {np.count_nonzero(solved.unshared)} of {len(solved.values)} frames several "
            "weights are as good, and the least of them could not be told within rounding; they "
            f"have one of the others; the first is frame {solved.unshared.argmax()}"
        )


def _unsolved(solved: Solved) -> Iterator[str]:
    if solved.unsolved.any():
        yield (
            f"in {np.count_nonzero(solved.unsolved)} of {len(solved.values)} frames the weights of "
            "least squares could not be found within rounding; they have none; the first is frame "
            f"{solved.unsolved.argmax()}"
        )
