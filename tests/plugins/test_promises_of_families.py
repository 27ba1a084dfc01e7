"""Each promise of a family is broken by some node, which is caught."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import wraps
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest

import nodegraph_despike
from nodegraph import Across, Truth, Unit, node
from nodegraph.node.decorator import node_of
from nodegraph.plugin.registry import default_registry
from nodegraph_align.huber import huber
from nodegraph_align.poses import Aligned
from nodegraph_align.procrustes import procrustes
from nodegraph_align.trimmed import trimmed
from nodegraph_blendshapes.animate_mesh import mesh
from nodegraph_blendshapes.from_head import from_head
from nodegraph_blendshapes.from_pca import from_pca
from nodegraph_blendshapes.pose import pose
from nodegraph_blendshapes.solve.weights import solve_weights
from nodegraph_combine.mean import mean
from nodegraph_fill.muscle import muscle
from nodegraph_mocap import (
    Animation,
    BlendshapeModel,
    Detections,
    Head,
    HeadMotion,
    Mask,
    Origin,
    Selection,
    Table,
    Trajectories,
    Weights,
)
from nodegraph_mocap.face_model import ModelAndNeutral
from nodegraph_select.variance import variance
from nodegraph_smooth.bspline import bspline
from nodegraph_synthesize.impulses import Spiky
from nodegraph_synthesize.impulses import add as add_impulses
from nodegraph_synthesize.noise import Noisy
from nodegraph_synthesize.noise import add as add_noise
from nodegraph_tables import TableInfo, with_info
from nodegraph_track.nearest import nearest
from tests.promises import Family

Spoil = Callable[[Any, Any], object]
"""Makes another result of what a node is given first and what it gives."""


class Broken(NamedTuple):
    base: Callable[..., object]
    spoil: Spoil
    promise: str
    says: str
    declared: Mapping[str, object] = {}


def as_it_is(_: object, after: object) -> object:
    return after


# What comes from a recording or points, and is a recording


def faster(_: object, after: Any) -> object:
    return replace(after, rate=2 * after.rate)


def shorter(_: Trajectories, after: Trajectories) -> Trajectories:
    sigma = None if after.sigma is None else after.sigma[1:]
    return replace(after, positions=after.positions[1:], origin=after.origin[1:], sigma=sigma)


def shrinks(_: Trajectories, after: Trajectories) -> Trajectories:
    return replace(after, positions=0.999 * after.positions)


def to_one_side(_: Trajectories, after: Trajectories) -> Trajectories:
    """Along one axis, by a millimetre however large the face is."""
    return replace(after, positions=after.positions + np.eye(3)[0])


def by_the_rate(_: Trajectories, after: Trajectories) -> Trajectories:
    return replace(after, positions=after.positions + after.rate)


def by_the_end(before: Trajectories, after: Trajectories) -> Trajectories:
    moved = np.nan_to_num(before.positions[-1] - before.positions[0])
    return replace(after, positions=after.positions + 0.1 * moved)


def first_first(_: Trajectories, after: Trajectories) -> Trajectories:
    positions = after.positions.copy()
    positions[:, 0] += 1.0
    return replace(after, positions=positions)


def repaired(_: Trajectories, after: Trajectories) -> Trajectories:
    return replace(after, origin=np.where(after.present, Origin.REPAIRED, Origin.MISSING))


def fills(_: Trajectories, after: Trajectories) -> Trajectories:
    missing = ~after.present
    positions = np.where(missing[..., None], 0.0, after.positions)
    return after.with_samples(positions, changed=missing, origin=Origin.FILLED)


def cuts(_: Trajectories, after: Trajectories) -> Trajectories:
    positions = after.positions.copy()
    positions[: len(positions) // 5] = np.nan
    return after.with_samples(positions, changed=np.isnan(positions[..., 0]), origin=Origin.MISSING)


def in_common(base: Callable[..., object]) -> list[Broken]:
    """Return what breaks the promises of families in which one recording becomes another."""
    return [
        Broken(base, faster, "takes_and_gives_a_recording", "rate went in as"),
        Broken(base, lambda _, after: replace(after, positions=after.positions / 1000.0),
               "gives_millimetres", "0.001 times as far from the origin"),
        Broken(base, by_the_end, "looks_ahead_as_declared", "declare a look", {"lookahead": 0}),
        Broken(base, shrinks, "moves_with_the_face", "differ, by up to"),
        Broken(base, to_one_side, "turns_with_the_face", "differ, by up to 1"),
        Broken(base, to_one_side, "scales_with_the_face", "differ, by up to 0.5 mm"),
        Broken(base, first_first, "does_not_depend_on_the_order_of_markers", "differ, by up to"),
    ]  # fmt: skip


def kept(recording: Trajectories) -> Trajectories:
    """Hand on."""
    return recording


def filled(recording: Trajectories) -> Trajectories:
    """Fill step by step, up to where the marker happens to come."""
    return muscle(recording)


def smoothed(recording: Trajectories) -> Trajectories:
    """Smooth."""
    return bspline(recording)


def other_port(take: Trajectories) -> Trajectories:
    """Hand on."""
    return take


# Alignments


def aligned(recording: Trajectories, reference: Trajectories | None = None) -> Aligned:
    """Align."""
    return procrustes(recording, reference)


def only_to_itself(recording: Trajectories, reference: Trajectories | None = None) -> Aligned:
    """Align to the recording's own first frame, whatever the reference."""
    return procrustes(recording)


class Renamed(NamedTuple):
    face: Trajectories
    head_motion: HeadMotion
    reference: Trajectories


def otherwise_called(recording: Trajectories, reference: Trajectories | None = None) -> Renamed:
    """Align, and call it otherwise."""
    return Renamed(*procrustes(recording, reference))


def gives_no_motion(_: Trajectories, output: Aligned) -> Aligned:
    still = np.zeros_like(output.head_motion.translations)
    return output._replace(head_motion=replace(output.head_motion, translations=still))


def keeps_sigma(_: Trajectories, output: Aligned) -> Aligned:
    motion = output.head_motion
    half = replace(motion, scales=2.0 * motion.scales)
    positions = 0.5 * output.aligned.positions
    return output._replace(aligned=replace(output.aligned, positions=positions), head_motion=half)


def turns_by_what_was_there(take: Trajectories, output: Aligned) -> Aligned:
    """A quarter turn about z in each frame, wherever the head was."""
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    motion = output.head_motion
    return output._replace(
        aligned=replace(output.aligned, positions=take.positions @ quarter.T),
        head_motion=replace(
            motion,
            rotations=np.tile(quarter.T, (take.frames, 1, 1)),
            translations=np.zeros((take.frames, 3)),
        ),
    )


def first(spoil: Spoil) -> Spoil:
    """Spoil the first of several outputs."""

    @wraps(spoil)
    def spoilt(before: Any, output: Any) -> object:
        return output._replace(**{output._fields[0]: spoil(before, output[0])})

    return spoilt


ALIGN = [
    Broken(aligned, first(faster), "takes_and_gives_a_recording", "rate went in as"),
    Broken(
        otherwise_called, as_it_is, "gives_the_face_its_motion_and_the_reference",
        "let it return aligned, head_motion, reference",
    ),
    Broken(aligned, lambda _, output: output._replace(reference=output.aligned),
           "gives_the_face_its_motion_and_the_reference", "reference has 40 frames: give the one"),
    Broken(aligned, first(fills), "keeps_gaps_and_origin", "with another origin: return"),
    Broken(aligned, first(first_first), "head_motion_leads_back", "differ, by up to"),
    Broken(aligned, gives_no_motion, "head_motion_leads_back", "differ, by up to"),
    Broken(aligned, keeps_sigma, "head_motion_leads_back", "sigma is not that of the samples"),
    Broken(aligned, turns_by_what_was_there, "what_is_aligned_stays", "differ, by up to"),
    Broken(aligned, turns_by_what_was_there, "where_the_head_is_does_not_matter", "differ, by"),
    Broken(only_to_itself, as_it_is, "where_the_head_is_does_not_matter", "differ, by up to"),
    Broken(aligned, first(first_first), "does_not_depend_on_the_order_of_markers", "differ, by"),
]  # fmt: skip

# Blendshapes


def of_head(head: Head) -> BlendshapeModel:
    """Build a model."""
    return from_head(head).model


def of_recording(recording: Trajectories) -> BlendshapeModel:
    """Build a model."""
    return from_pca(recording).model


def no_model(head: Head) -> Head:
    """Give the head."""
    return head


def with_another_neutral(head: Head) -> ModelAndNeutral:
    """Build a model, and give another neutral."""
    both = from_head(head)
    moved = replace(both.neutral, positions=both.neutral.positions + 1.0)
    return both._replace(neutral=moved)


def posed_by_column(weights: Weights, model: BlendshapeModel) -> Trajectories:
    """Pose, by column."""
    return pose(replace(weights, names=model.names), model)


def larger_first(_: object, model: BlendshapeModel) -> BlendshapeModel:
    shapes = model.shapes.copy()
    shapes[:, 0] *= 2
    return replace(model, shapes=shapes)


BLENDSHAPES = [
    Broken(no_model, as_it_is, "gives_a_model_or_a_recording", "its first output is Head"),
    Broken(with_another_neutral, as_it_is, "neutral_is_that_of_the_model", "from the model's"),
    Broken(posed_by_column, as_it_is, "does_not_depend_on_the_order_of_shapes", "differ by"),
    *(
        Broken(base, spoil, promise, says)
        for base in (of_head, of_recording)
        for spoil, promise, says in (
            (lambda _, model: replace(model, markers=model.markers[::-1]),
             "keeps_the_markers", "markers went in as"),
            (lambda _, model: replace(model, neutral=model.neutral - model.neutral.mean(axis=0)),
             "moves_with_the_face", "positions differ by up to"),
            (lambda _, model: replace(model, shapes=model.shapes * [1.0, 1.0, 0.0]),
             "moves_with_the_face", "positions differ by up to"),
            (larger_first, "does_not_depend_on_the_order_of_markers", "positions differ by"),
        )
    ),
]  # fmt: skip


def animated(weights: Weights, head: Head) -> Animation:
    """Animate."""
    return mesh(weights, head)


def animated_by_curves(curves: Weights, head: Head) -> Animation:
    """Animate."""
    return mesh(curves, head)


def doubled(_: object, animation: Animation) -> Animation:
    weights = replace(animation.weights, values=2 * animation.weights.values)
    return replace(animation, weights=weights)


def plays_faster(_: object, animation: Animation) -> Animation:
    return replace(animation, weights=replace(animation.weights, rate=2 * animation.rate))


def swollen(_: object, animation: Animation) -> Animation:
    vertices = 1.1 * np.array(animation.head.vertices)
    return replace(animation, head=replace(animation.head, vertices=vertices))


ANIMATE = [
    Broken(base, spoil, "gives_an_animation_of_its_weights", says)
    for base, spoil, says in (
        (animated_by_curves, as_it_is, "name them `weights` and `head`"),
        (animated, doubled, "weights went in otherwise than they came out: jawOpen"),
        (animated, plays_faster, "frames at 60.0 Hz became"),
        (animated, swollen, "the head that it animates is not the one"),
    )
]  # fmt: skip


def solved(recording: Trajectories, model: BlendshapeModel) -> Weights:
    """Find weights."""
    return solve_weights(recording, model).weights


def solved_within_other_bounds(
    recording: Trajectories, model: BlendshapeModel, *, bounds: tuple[float, float] = (0.0, 0.3)
) -> Weights:
    """Find weights within other bounds.

    Parameters
    ----------
    bounds
        Not kept to.
    """
    return solve_weights(recording, model).weights


def first_marker(recording: Trajectories, weights: Weights) -> Weights:
    extra = 1e-3 * np.nan_to_num(recording.positions[:, :1, 0])
    return replace(weights, values=weights.values + extra)


def millimetres(recording: Trajectories, weights: Weights) -> Weights:
    return replace(weights, values=weights.values + 1e-3 * np.nanmax(recording.positions))


def favourite(_: Trajectories, weights: Weights) -> Weights:
    values = weights.values.copy()
    values[:, 0] += 0.25
    return replace(weights, values=values)


SOLVE = [
    Broken(solved, lambda _, weights: replace(weights, names=tuple(f"{x}s" for x in weights.names)),
           "gives_weights_of_the_models_shapes", "the model's shapes are"),
    Broken(solved, faster, "gives_weights_of_the_models_shapes", "Hz came out"),
    Broken(solved_within_other_bounds, as_it_is, "keeps_to_its_bounds", "is outside"),
    Broken(solved, lambda _, weights: replace(weights, values=np.nan_to_num(weights.values)),
           "knows_nothing_of_empty_frames", "has no marker"),
    Broken(solved, first_marker, "does_not_depend_on_the_order_of_markers", "reversed: frame"),
    Broken(solved, millimetres, "scales_with_face_and_model", "twice as large: frame"),
    Broken(solved, favourite, "identical_shapes_share", "they differ by 0.25"),
]  # fmt: skip

# Several recordings


def combined(recordings: Across[Trajectories]) -> Trajectories:
    """Combine."""
    return mean(recordings)


COMBINE = [
    Broken(combined, faster, "takes_recordings_and_gives_one", "rate went in as"),
    Broken(combined, to_one_side, "keeps_what_all_have_alike", "samples that all have alike are"),
    Broken(combined, lambda recordings, _: recordings.values()[0],
           "does_not_depend_on_the_order", "give another result"),
    Broken(combined, shrinks, "moves_with_the_face", "shifted recordings give another result"),
]  # fmt: skip

# Impulses


def repair(recording: Trajectories, positions: Any, bad: Any) -> Trajectories:
    sigma = None if recording.sigma is None else np.where(bad, np.nan, recording.sigma)
    return recording.with_samples(positions, changed=bad, origin=Origin.REPAIRED, sigma=sigma)


def first_frame(recording: Trajectories) -> Any:
    chosen = np.zeros(recording.origin.shape, dtype=bool)
    chosen[0] = recording.present[0]
    return chosen


def does_not_mark(before: Trajectories, _: Trajectories) -> Trajectories:
    marked = repair(before, before.positions + first_frame(before)[..., None], first_frame(before))
    return replace(marked, origin=before.origin)


def marks_too_much(before: Trajectories, _: Trajectories) -> Trajectories:
    bad = first_frame(before) & (before.origin == Origin.MEASURED)
    return replace(before, origin=np.where(bad, np.uint8(Origin.REPAIRED), before.origin))


def keeps_sigma_of_what_was(before: Trajectories, _: Trajectories) -> Trajectories:
    bad = first_frame(before)
    moved = before.positions + bad[..., None]
    return before.with_samples(moved, changed=bad, origin=Origin.REPAIRED)


def by_place(before: Trajectories, _: Trajectories) -> Trajectories:
    bad = first_frame(before) & (before.positions[..., 0] > 0)
    return repair(before, before.positions + bad[..., None], bad)


DESPIKE = [
    *in_common(kept),
    Broken(kept, by_the_rate, "runs_with_the_clock", "differ, by up to"),
    Broken(kept, fills, "missing_stays_missing", "filled"),
    Broken(kept, cuts, "missing_stays_missing", "removed"),
    Broken(kept, does_not_mark, "repaired_samples_are_marked", "changed but not marked"),
    Broken(kept, marks_too_much, "repaired_samples_are_marked", "not changed but newly marked"),
    Broken(kept, keeps_sigma_of_what_was, "sigma_belongs_to_its_sample", "of what it was"),
    Broken(kept, lambda before, _: replace(before, sigma=None),
           "sigma_belongs_to_its_sample", "sigma is gone"),
    Broken(
        kept,
        lambda before, _: (
            before if before.sigma is None else replace(before, sigma=before.sigma * 2)
        ),
        "sigma_belongs_to_its_sample",
        "but with another sigma",
    ),
    Broken(kept, by_place, "moves_with_the_face", "differ, by up to 1.73 mm"),
]  # fmt: skip


def unmarked(before: Trajectories, after: Trajectories) -> Trajectories:
    return replace(after, origin=np.where(before.present, before.origin, after.present))


FILL = [
    *in_common(filled),
    Broken(filled, to_one_side, "present_samples_stay", "write where ~recording.present only"),
    Broken(filled, unmarked, "written_samples_are_marked", "written but not marked"),
    Broken(filled, repaired, "written_samples_are_marked", "not written but newly marked"),
    Broken(
        filled, as_it_is, "meets_the_ends_as_declared",
        "frames 20 to 27, marker 'cheek_left': jumps by", {"ends": True},
    ),
]  # fmt: skip

# Gaps, noise and impulses that are made


class Cut(NamedTuple):
    gappy: Trajectories
    truth: Truth[Trajectories]
    hidden: Mask


def cut(recording: Trajectories) -> Cut:
    """Hide every third frame."""
    hidden = recording.present.copy()
    hidden[np.arange(recording.frames) % 3 > 0] = False
    gappy = without(recording, hidden)
    return Cut(gappy, recording, Mask(hidden=hidden, markers=recording.markers))


def without(recording: Trajectories, hidden: Any) -> Trajectories:
    positions = np.where(hidden[..., None], np.nan, recording.positions)
    return recording.with_samples(positions, changed=hidden, origin=Origin.MISSING)


def other_truth(_: object, output: Any) -> object:
    truth = replace(output.truth, positions=output.truth.positions + 1e-9)
    return output._replace(truth=truth)


def other_origin(_: object, output: Any) -> object:
    origin = np.where(output.truth.present, Origin.FILLED, Origin.MISSING)
    return output._replace(truth=replace(output.truth, origin=origin))


def slightly(_: object, after: Trajectories) -> Trajectories:
    return replace(after, positions=after.positions + 1e-9)


def missing_before(_: object, output: Cut) -> Cut:
    everything = np.ones_like(output.hidden.hidden)
    hidden = replace(output.hidden, hidden=everything)
    return output._replace(gappy=without(output.truth, everything), hidden=hidden)


GAPS = [
    Broken(kept, as_it_is, "has_the_ports_of_a_cut", "'hidden' is not a Mask; its ports are rec"),
    Broken(cut, other_truth, "truth_is_the_recording", "return it as it came"),
    Broken(cut, other_origin, "truth_is_the_recording", "return it as it came"),
    Broken(cut, first(slightly), "hides_what_it_says", "samples that are not hidden differ"),
    Broken(cut, first(lambda before, _: before),
           "hides_what_it_says", "hidden samples are still there"),
    Broken(cut, missing_before, "hides_what_it_says", "hidden samples were missing before"),
]  # fmt: skip


def noisy(recording: Trajectories) -> Noisy:
    """Add noise."""
    return add_noise(recording)


def spiky(recording: Trajectories) -> Spiky:
    """Add impulses."""
    return add_impulses(recording, share=0.1)


def spikes_alone(recording: Trajectories) -> Mask:
    """Hit nothing."""
    return Mask(hidden=np.zeros_like(recording.present), markers=recording.markers)


MADE = [
    Broken(base, spoil, promise, says)
    for base in (noisy, spiky)
    for spoil, promise, says in (
        (other_truth, "truth_is_the_recording", "return it as it came"),
        (first(fills), "keeps_what_is_missing", "origins differ from the recording's"),
        (first(repaired), "keeps_what_is_missing", "origins differ from the recording's"),
    )
]
NOISE = [
    Broken(kept, as_it_is, "gives_noisy_and_truth", "'noisy' is not a Trajectories; its ports"),
    *(row for row in MADE if row.base is noisy),
]  # fmt: skip
IMPULSES = [
    Broken(spikes_alone, as_it_is, "gives_spiky_truth_and_impulses", "is 'output', not 'spiky'"),
    *(row for row in MADE if row.base is spiky),
    Broken(spiky, first(to_one_side), "hits_what_it_says", "that are not among the impulses"),
    Broken(spiky, first(lambda before, _: before),
           "hits_what_it_says", "are where nothing differs"),
]  # fmt: skip

# Markers and scores


def twice(_: Trajectories, after: Trajectories) -> Trajectories:
    return replace(
        after,
        positions=np.concatenate([after.positions] * 2, axis=1),
        origin=np.concatenate([after.origin] * 2, axis=1),
        sigma=None,
        markers=(*after.markers, *(f"{name}_again" for name in after.markers)),
    )


MARKERS = [
    Broken(other_port, as_it_is,
           "gives_a_recording_of_the_same_frames", "name the recording `recording`"),
    Broken(kept, shorter, "gives_a_recording_of_the_same_frames", "frames went in as"),
    Broken(kept, slightly, "moves_no_sample", "samples are none of their frame"),
    Broken(kept, repaired, "moves_no_sample", "or their origin changed"),
    Broken(kept, twice, "moves_no_sample", "samples are used more than once"),
]  # fmt: skip


def worst(estimate: Trajectories, truth: Truth[Trajectories]) -> Table:
    """Largest distance of each marker."""
    from pandas import DataFrame

    apart = np.linalg.norm(estimate.positions - truth.positions, axis=2)
    table = DataFrame({"marker": truth.markers, "worst": apart.max(axis=0, initial=0.0)})
    table = with_info(table, TableInfo(units={"worst": "mm"}))
    return table


def no_score(estimate: Trajectories) -> Trajectories:
    """Return no score."""
    return estimate


SCORE = [
    Broken(no_score, as_it_is, "gives_a_table", "not a pandas DataFrame"),
    Broken(worst, lambda _, table: table.assign(worst=table["worst"] + 1.0),
           "the_answer_scores_zero", "column 'worst' has 1 mm"),
    Broken(worst, lambda _, table: table.assign(worst=table["worst"] / 1000.0),
           "marks_millimetres", "column 'worst' has 0.001 mm"),
]  # fmt: skip

# Selections


def chosen(recording: Trajectories) -> Selection:
    """Choose five markers."""
    return variance(recording, k=5)


def chosen_of_a_take(take: Trajectories) -> Selection:
    """Choose five markers."""
    return variance(take, k=5)


def forgets_a_pair(_: Trajectories, selection: Selection) -> Selection:
    left = tuple(pair for pair in selection.pairs if pair[0] in selection.chosen)
    return Selection(chosen=selection.chosen, pairs=left)


def nearest_to_zero(recording: Trajectories, _: Selection) -> Selection:
    return whole(recording, recording.markers[int(np.abs(recording.positions[0, :, 0]).argmin())])


def topmost(recording: Trajectories, _: Selection) -> Selection:
    return whole(recording, recording.markers[int(recording.positions[0, :, 1].argmax())])


def by_the_millimetre(recording: Trajectories, _: Selection) -> Selection:
    return variance(recording, k=2 if np.ptp(recording.positions[..., 0]) > 200.0 else 5)


def whole(recording: Trajectories, name: str) -> Selection:
    pairs = recording.marker_set.pairs if recording.marker_set else ()
    chosen = next((pair for pair in pairs if name in pair), (name,))
    return Selection(chosen=tuple(value for value in recording.markers if value in chosen))


SELECT = [
    Broken(
        chosen_of_a_take, as_it_is, "takes_a_recording_and_gives_a_selection",
        "its ports are take; name the recording `recording`",
    ),
    Broken(
        kept, as_it_is, "takes_a_recording_and_gives_a_selection",
        "its first output is not a selection; it gives",
    ),
    *(
        Broken(chosen, spoil, promise, says)
        for spoil, promise, says in (
            (lambda *_: Selection(chosen=()), "chooses_markers_of_the_recording", "chooses none"),
            (lambda *_: Selection(chosen=("tail",)),
             "chooses_markers_of_the_recording", "tail, which the recording lacks"),
            (lambda _, selection: replace(selection, chosen=selection.chosen[::-1]),
             "chooses_markers_of_the_recording", "the recording has them in another"),
            (lambda _, selection: Selection(chosen=selection.chosen[:3]),
             "keeps_pairs_whole", "of the pair"),
            (forgets_a_pair, "names_every_marker_once", "pairs and markers differ in"),
            (lambda recording, _: whole(recording, recording.markers[0]),
             "does_not_depend_on_the_order_of_markers", "the reordered one has"),
            (nearest_to_zero, "does_not_depend_on_the_origin", "the shifted one has"),
            (topmost, "does_not_depend_on_the_axes", "the turned one has"),
            (by_the_millimetre, "does_not_depend_on_the_size", "the enlarged one has"),
        )
    ),
]  # fmt: skip

# Smoothings


def smoothed_long(recording: Trajectories) -> Trajectories:
    """Smooth with a long window."""
    return bspline(recording, order=9)


def late(_: Trajectories, after: Trajectories) -> Trajectories:
    """Two frames late, and still looking ahead."""
    positions = after.positions.copy()
    there = after.present[2:] & after.present[:-2]
    positions[2:][there] = after.positions[:-2][there]
    return replace(after, positions=positions)


def early(_: Trajectories, after: Trajectories) -> Trajectories:
    positions = after.positions.copy()
    there = after.present[1:] & after.present[:-1]
    positions[:-1][there] = after.positions[1:][there]
    return replace(after, positions=positions)


SMOOTH = [
    *in_common(smoothed),
    Broken(other_port, as_it_is, "takes_and_gives_a_recording", "name the recording `recording`"),
    Broken(smoothed, lambda _, after: replace(after, marker_set=None),
           "takes_and_gives_a_recording", "marker_set went in as"),
    Broken(smoothed, by_the_rate, "runs_with_the_clock", "differ, by up to"),
    Broken(smoothed, fills, "adds_no_gap_and_fills_none", "filled: leave that to a fill"),
    Broken(smoothed, cuts, "adds_no_gap_and_fills_none", "smooth each run of present samples"),
    Broken(smoothed, repaired, "adds_no_gap_and_fills_none", "called otherwise: return"),
    Broken(smoothed, early, "shifts_nothing_in_time", "comes out 1.00 frames early, although"),
    Broken(smoothed_long, late, "shifts_nothing_in_time", "comes out 2.00 frames late, although"),
    Broken(smoothed, lambda before, after: replace(after, sigma=before.sigma),
           "sigma_belongs_to_its_sample", "changed but with its old sigma"),
]  # fmt: skip

# Tracks


def tracked(detections: Detections) -> Trajectories:
    """Follow points."""
    return nearest(detections, shortest=1)


def tracked_by_another_port(points: Detections) -> Trajectories:
    """Follow points."""
    return nearest(points)


def by_order(detections: Detections, after: Trajectories) -> Trajectories:
    nearest_first = np.argmin(np.abs(after.positions[0] - detections.points[0]).sum(axis=1))
    return after.keep([name for i, name in enumerate(after.markers) if i != nearest_first])


def one_side(_: Detections, after: Trajectories) -> Trajectories:
    positions = np.where(after.positions[..., :1] > 0, after.positions, np.nan)
    return Trajectories(positions=positions, markers=after.markers, rate=after.rate)


TRACK = [
    Broken(tracked_by_another_port, as_it_is,
           "takes_points_and_gives_a_recording", "name the points `detections`"),
    Broken(tracked, faster, "takes_points_and_gives_a_recording", "rate went in as"),
    Broken(tracked, slightly, "gives_each_point_once", "samples are not points of their frame"),
    Broken(tracked, twice, "gives_each_point_once", "points are used more than once"),
    Broken(tracked, by_order, "does_not_depend_on_the_order_of_points", "give other tracks"),
    Broken(tracked, one_side, "moves_with_the_points", "the turned points give other tracks"),
]  # fmt: skip

BROKEN = {
    "align": ALIGN, "animate": ANIMATE, "blendshapes": BLENDSHAPES, "combine": COMBINE,
    "despike": DESPIKE, "fill": FILL, "gaps": GAPS, "impulses": IMPULSES, "markers": MARKERS,
    "noise": NOISE, "score": SCORE, "select": SELECT, "smooth": SMOOTH, "solve": SOLVE,
    "track": TRACK,
}  # fmt: skip
PLUGINS = {
    "animate": "blendshapes", "impulses": "synthesize", "noise": "synthesize",
    "solve": "blendshapes",
}  # fmt: skip


def family_of(name: str) -> Family:
    return Family(name, PLUGINS.get(name, ""))


def promises(name: str) -> dict[str, str]:
    """Return the first line of each promise of a family, by its name."""
    return {
        contract.__name__: (contract.__doc__ or "").strip().splitlines()[0].rstrip(".")
        for plugin in default_registry().loaded
        for family, contracts in getattr(plugin.module, "nodegraph_contracts", dict)().items()
        if family == name
        for contract in contracts
    }


def broken(row: Broken) -> Callable[..., object]:
    """Return the function of a row, spoilt."""

    @wraps(row.base)
    def tried(*inputs: object, **named: object) -> object:
        given = next(iter((*inputs, *named.values())))
        return row.spoil(given, row.base(*inputs, **named))

    return tried


def rows() -> Iterator[object]:
    for family, table in BROKEN.items():
        for row in table:
            yield pytest.param(family, row, id=f"{family}: {row.promise}, {row.says}")


@pytest.mark.filterwarnings("ignore:.*chosen or left each by itself")
@pytest.mark.parametrize(("family", "row"), list(rows()))
def test_a_node_that_breaks_a_promise_is_caught(family: str, row: Broken) -> None:
    function = broken(row)
    if row.declared:
        function = node(f"{family}.tried", **row.declared)(function)  # type: ignore[call-overload]
    promise = re.escape(promises(family)[row.promise])
    text = family_of(family).refuses(function, f"{promise}.*\n.*{re.escape(row.says)}")
    assert "KeyError" not in text


@pytest.mark.parametrize("family", sorted(BROKEN))
def test_every_promise_of_a_family_is_broken_by_some_node(family: str) -> None:
    assert {row.promise for row in BROKEN[family]} == set(promises(family))


@pytest.mark.filterwarnings("ignore:.*chosen or left each by itself")
@pytest.mark.parametrize("family", sorted(BROKEN))
def test_what_is_spoilt_keeps_every_promise_before(family: str) -> None:
    for base in {row.base: None for row in BROKEN[family] if row.spoil is not as_it_is}:
        family_of(family).accepts(base)


def partly_aligned(recording: Trajectories, reference: Trajectories | None = None) -> Aligned:
    """Align all frames but the last, which cannot be."""
    output = procrustes(recording, reference)
    positions, motion = output.aligned.positions.copy(), output.head_motion
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    positions[-1], rotations[-1], translations[-1] = recording.positions[-1], np.eye(3), 0.0
    turned = replace(motion, rotations=rotations, translations=translations)
    return output._replace(aligned=replace(output.aligned, positions=positions), head_motion=turned)


def chosen_by_an_axis(recording: Trajectories) -> Selection:
    """Choose the topmost marker of a complete take. It depends on the axes."""
    return topmost(recording, variance(recording, k=1))


def lagging(recording: Trajectories) -> Trajectories:
    """Smooth causally: the mean of each sample and the one before."""
    positions = recording.positions.copy()
    there = recording.present[1:] & recording.present[:-1]
    before, after = recording.positions[:-1][there], recording.positions[1:][there]
    positions[1:][there] = 0.5 * (before + after)
    sigma = None if recording.sigma is None else np.full_like(recording.sigma, np.nan)
    return replace(recording, positions=positions, sigma=sigma)


def stepwise(recording: Trajectories, *, most: Annotated[float, Unit("mm")] = 0.01) -> Trajectories:
    """Smooth each coordinate by itself, small deviations only: depends on the axes.

    Parameters
    ----------
    most
        By how much a coordinate may change.
    """
    change = bspline(recording).positions - recording.positions
    small = np.sign(change) * np.minimum(np.abs(change), most)
    return replace(recording, positions=recording.positions + small, sigma=None)


@pytest.mark.filterwarnings("ignore:.*chosen or left each by itself")
@pytest.mark.parametrize(
    ("family", "function"),
    [
        ("align", partly_aligned),
        ("select", chosen_by_an_axis),
        ("smooth", lagging),
        ("smooth", stepwise),
    ],
)
def test_what_a_promise_exempts_is_no_fault(family: str, function: Callable[..., object]) -> None:
    family_of(family).accepts(function)


@pytest.mark.parametrize(
    ("align", "settings"),
    [
        (procrustes, {"steps": ()}),
        (procrustes, {"steps": ("translate", "scale"), "scale": "rms"}),
        (trimmed, {"share": 0.5}),
        (huber, {"width": 0.1, "scale": "rms"}),
    ],
)
def test_good_alignments_pass(align: Callable[..., Aligned], settings: dict[str, object]) -> None:
    family_of("align").accepts(align, **settings)


@pytest.mark.parametrize("despiker", list(nodegraph_despike.nodegraph_nodes()))
def test_good_despikers_pass_where_they_repair_much(
    despiker: Callable[..., Trajectories],
) -> None:
    known = node_of(despiker)
    assert known is not None
    names = [name for name in ("factor", "threshold") if name in known.settings]
    family_of("despike").accepts(despiker, **dict.fromkeys(names, 0.05))
