"""A synthetic face with known ground truth."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from pydantic import Field

from nodegraph import Truth, Unit, node
from nodegraph_mocap import (
    BlendshapeModel,
    Detections,
    Head,
    HeadMotion,
    MarkerSet,
    Mask,
    Origin,
    Trajectories,
    Weights,
)
from nodegraph_mocap.random_numbers import Seed, random_for
from nodegraph_synthesize.activation import activations
from nodegraph_synthesize.actor import Actor, draw_actor, head_of
from nodegraph_synthesize.damage import impulses as impulses_on
from nodegraph_synthesize.damage import occlusions, unlabelled
from nodegraph_synthesize.movement import head_motion as motion_of_head
from nodegraph_synthesize.movement import moved, own_movement, skin_movement, tempo
from nodegraph_synthesize.muscles import CHANNELS
from nodegraph_synthesize.noise import noise_of

if TYPE_CHECKING:
    from numpy.typing import NDArray


class SyntheticFace(NamedTuple):
    """Outputs of `synthesize.face`."""

    captured: Trajectories
    detections: Detections
    neutral: Trajectories
    marker_set: MarkerSet
    model: BlendshapeModel
    head: Head
    truth: Truth[Trajectories]
    weights: Truth[Weights]
    head_motion: Truth[HeadMotion]
    impulses: Truth[Mask]


@node(
    "synthesize.face",
    cite=("waters1987", "ekman1978", "goldman-eisler1968", "vanderwerf2003", "schmidt2006"),
    synthetic=True,
)
def synthesize_face(
    *,
    seconds: Annotated[float, Field(gt=0, le=3600), Unit("s")] = 10.0,
    rate: Annotated[float, Field(gt=0, le=1000), Unit("Hz")] = 60.0,
    markers: Annotated[int, Field(ge=10, le=150)] = 60,
    noise: Annotated[float, Field(ge=0, le=100), Unit("mm")] = 0.1,
    noise_cutoff: Annotated[float | None, Field(gt=0, le=1000), Unit("Hz")] = None,
    residual: Annotated[float, Field(ge=0, le=1), Unit("share")] = 0.15,
    missing: Annotated[float, Field(ge=0, le=0.5)] = 0.05,
    impulses: Annotated[float, Field(ge=0, le=0.2)] = 0.005,
    head_motion: bool = True,
    seed: Annotated[int, Field(ge=0)] = 0,
    take: Annotated[int, Field(ge=0)] = 0,
) -> SyntheticFace:
    """Make a face that speaks, blinks and moves its head, and record it with known damage.

    A symmetric face with muscles of Waters' kinds [1]_, a jaw that turns and eyes that close,
    driven by smooth random activations. The take begins at rest: for 0.3 s, or a tenth of a take
    shorter than 3 s, it is the neutral. Then expressions, each of the muscles that the Facial
    Action Coding System [2]_ names for it, are held for a second or two one after the other;
    between them, and through some of them, the actor speaks. The pull of a muscle follows the
    moving skin, the skin stiffens and slides over the skull, and moves a little by itself, so
    the recording is not exactly low-rank. Every seed is another actor: other proportions,
    strengths and habits.

    The face moves in bursts with rests between, as people's do: pauses take about half of the time
    of speech [3]_, an expression is over before the next begins, at its apex it is still, blinks
    take a third of a second [4]_, onsets half of one [5]_, and skin moves by itself mostly where
    muscles do. By `score.realism`, in takes of 20 s, the kurtosis of velocity is 4 to 7 and the
    99.9th percentile of the speed 40 to 90 mm/s. Shorter takes hold few movements and spread wider.

    Parameters
    ----------
    seconds
        Length of the recording; rounded to whole frames, two at least.
    rate
        Frames per second.
    markers
        Number of markers. The usual 60 are brows, eyelids, nose, cheeks, lips, jaw, forehead
        and temples; fewer are a part of these, more fill the spaces between them.
    noise
        Standard deviation of the measurement noise of each coordinate.
    noise_cutoff
        The noise is low-passed there, as in a recording that was low-passed before it was
        published; see `noise.add`. None: white, as cameras make it.
    residual
        Each marker's movement by itself, which it shares with no neighbour, as a share of the
        standard deviation of its movement by muscles: red, its power falling as ``f^-3``. From
        one actor, on whose markers it is 10 to 20 % (AnimFace, Carretero 2019); in two people of
        another laboratory neighbours share more.
    missing
        Share of all samples that are hidden: occlusions of 1 to 40 frames, some of them of
        several neighbours together.
    impulses
        Share of the present samples that are off by 4 to 10 mm for a single frame.
    head_motion
        Whether the head moves: turns of less than 5 degrees, shifts of less than 1/20 of the
        head's length.
    seed
        Seed of the actor, the performance and the damage, each drawn by itself: another `noise`
        changes neither the performance nor the gaps.
    take
        Another number is another performance, with other damage, of the same actor.

    Returns
    -------
    captured : Trajectories
        Truth with noise, impulses and gaps.
    detections : Detections
        The present samples of `captured` without names, in random order.
    neutral : Trajectories
        One frame: the face at rest, where the head is at rest.
    marker_set : MarkerSet
        Pairs, midline, stable markers (temples, nose, upper forehead) and edges to draw.
    model : BlendshapeModel
        A shape per activation: the displacement when it alone is 1.
    head : Head
        The whole face with the same shapes.
    truth : Trajectories
        Complete, without noise; ``R aligned + t`` of `head_motion`; the neutral exactly at rest.
    weights : Weights
        The activations, in [0, 1].
    head_motion : HeadMotion
        Scales are 1; rests as long as the face does.
    impulses : Mask
        Samples that an impulse has hit.

    Raises
    ------
    ValueError
        If the recording would have fewer than two frames, or the cut-off is not below half the
        rate.

    References
    ----------
    .. [1] K. Waters, A muscle model for animating three-dimensional facial expression,
       SIGGRAPH '87, 17-24.
    .. [2] P. Ekman and W. V. Friesen, Facial Action Coding System: a technique for the
       measurement of facial movement, Consulting Psychologists Press, 1978.
    .. [3] F. Goldman-Eisler, Psycholinguistics: Experiments in spontaneous speech, Academic
       Press, 1968.
    .. [4] F. VanderWerf et al., Eyelid movements: behavioral studies of blinking in humans under
       different stimulus conditions, Journal of Neurophysiology 89 (2003), 2784-2796.
    .. [5] K. L. Schmidt et al., Movement differences between deliberate and spontaneous facial
       expressions: zygomaticus major action in smiling, Journal of Nonverbal Behavior 30 (2006),
       37-52.
    """
    frames = _frames(seconds, rate)
    actor = draw_actor(seed)
    head, marker_set = head_of(actor, markers)
    points = head.vertices[head.marker_vertices]
    drawn: Seed = (seed, take) if take else seed
    weights = activations(random_for("activations", drawn), actor.habits, frames, rate)
    motion = _motion(drawn, actor, frames, rate) if head_motion else HeadMotion.still(frames)
    aligned = _aligned(drawn, actor, points, marker_set.markers, weights, rate, residual)
    truth = _recording(moved(aligned, motion), marker_set, rate)
    hidden = occlusions(random_for("occlusions", drawn), missing, frames, points)
    hit, jumps = impulses_on(random_for("impulses", drawn), impulses, ~hidden)
    shaken = noise * noise_of(random_for("noise", drawn), jumps.shape, noise_cutoff, rate)
    captured = _captured(truth, shaken + jumps, hidden)
    return SyntheticFace(
        captured=captured,
        detections=unlabelled(random_for("order", drawn), captured),
        neutral=_recording(points[None], marker_set, rate),
        marker_set=marker_set,
        model=head.model,
        head=head,
        truth=truth,
        weights=Weights(values=weights, names=CHANNELS, rate=rate),
        head_motion=motion,
        impulses=Mask(hidden=hit, markers=marker_set.markers),
    )


def _frames(seconds: float, rate: float) -> int:
    frames = round(seconds * rate)
    if frames < 2:
        raise ValueError(
            f"{seconds} s at {rate} Hz are {frames} frames; a recording needs two at least"
        )
    return frames


def _motion(seed: Seed, actor: Actor, frames: int, rate: float) -> HeadMotion:
    length = actor.proportions.face_length
    return motion_of_head(random_for("head motion", seed), frames, rate, length)


def _aligned(
    seed: Seed,
    actor: Actor,
    points: NDArray[np.float64],
    names: tuple[str, ...],
    weights: NDArray[np.float64],
    rate: float,
    residual: float,
) -> NDArray[np.float64]:
    """Return (T, M, 3) mm of the face without its head motion."""
    clock = tempo(weights, rate)
    skin = skin_movement(random_for("skin", seed), points, clock, rate)
    pulled = actor.anatomy(points).offsets(weights)
    if residual:
        extents = residual * np.sqrt(pulled.var(axis=0).sum(axis=1))
        for column, (name, extent) in enumerate(zip(names, extents, strict=True)):
            random = random_for(f"own movement of {name}", seed)
            skin[:, column] += own_movement(random, extent, clock, rate)
    return np.asarray(points + pulled + skin)


def _captured(
    truth: Trajectories, errors: NDArray[np.float64], hidden: NDArray[np.bool_]
) -> Trajectories:
    positions = np.where(hidden[..., None], np.nan, truth.positions + errors)
    return truth.with_samples(positions, changed=~hidden, origin=Origin.MEASURED)


def _recording(positions: NDArray[np.float64], marker_set: MarkerSet, rate: float) -> Trajectories:
    return Trajectories(
        positions=positions, markers=marker_set.markers, rate=rate, marker_set=marker_set
    )
