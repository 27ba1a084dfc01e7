"""Pairs of markers drawn at random: what a method must beat."""

from __future__ import annotations

from nodegraph import node
from nodegraph_mocap import Selection
from nodegraph_mocap.random_numbers import Seed, random_for
from nodegraph_select.pairs import pairs_of
from nodegraph_select.ranking import Wanted, first_pairs


@node("select.random", shares=Wanted)
def random(wanted: Wanted, *, seed: Seed = 0) -> Selection:
    """Choose pairs of markers at random.

    All pairs, left and right, and all markers of the midline are put into a random order, each
    order being equally likely; the first are chosen, as many as it takes for k markers. A larger
    k with the same seed adds to the same selection. Where a marker lies and how it moves does
    not matter, and samples may be missing.

    Parameters
    ----------
    recording
        Whose markers, and whose marker set's pairs; a marker that is in no pair is alone, with
        a warning unless it is on the midline.
    seed
        Number of the random order. A list, such as ``[$trial, $recording]`` in a graph, is another
        seed for each recording.

    Returns
    -------
    Selection
        The markers chosen, in the order of the recording, and all pairs.

    Raises
    ------
    Refusal
        If the recording has fewer than k markers.
    """
    recording, count = wanted.recording, wanted.count()
    pairs = pairs_of(recording, stacklevel=4)
    # by name, so that nothing hangs on the order in a file
    drawn = random_for("select.random", seed).permutation(
        sorted(range(len(pairs)), key=lambda number: min(pairs[number]))
    )
    return first_pairs(recording, pairs, drawn, count)
