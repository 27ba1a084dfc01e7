"""Values that were read from files, played together on one clock."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from nodegraph import Refusal, Rendered
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.face_model import BlendshapeModel, Weights
from nodegraph_mocap.head import Head
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.marks import BESIDE, Mark, Marks
from nodegraph_mocap.playback import Curves, Panel, Playback
from nodegraph_mocap.player.fitting import (
    check_meshes,
    frames_apart,
    out_of_reach,
    thinned,
    thinned_weights,
    thinning_notes,
)
from nodegraph_mocap.player.page import render_view
from nodegraph_mocap.player.panels import panel_of
from nodegraph_mocap.player.spans import render_spans
from nodegraph_mocap.player.strip import strip_of
from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.shape_names import places_of
from nodegraph_mocap.view import AUTO

_RATE = 30.0
_FRAMES = 30
"""Of each shape that is shown by itself; the first is at rest."""


def view(values: Mapping[str, object]) -> Rendered:
    """Return the player of values by label.

    A head or a model moves as the weights say whose names are its own, of the first that fit;
    otherwise its shapes are shown one after the other. A marker set joins the markers of
    the recordings that have them and no set of their own. Marks are applied to the recording that
    they lie beside, or the first that has their markers, and are drawn alone without one; every
    other recording can be marked, and those whose marks lie beside them.

    Raises
    ------
    Refusal
        If there is nothing to see, or it cannot be drawn.
    """
    spans = {label: value for label, value in values.items() if isinstance(value, Marks)}
    if spans and all(isinstance(value, (Marks, MarkerSet)) for value in values.values()):
        return render_spans(spans)
    files = _Files(values)
    try:
        return render_view(files.playback(), ", ".join(values))
    except ValueError as error:
        raise Refusal(str(error)) from None


class _Files:
    """Values that are sorted into what moves in space, and curves."""

    def __init__(self, values: Mapping[str, object]) -> None:
        self._values = values
        self._notes: list[str] = []
        self._shown: dict[str, Trajectories | Animation] = {}
        self._curves: dict[str, Weights] = {}
        self._marks: dict[str, tuple[Mark, ...]] = {}
        self._marked_elsewhere: set[str] = set()
        for label, value in values.items():
            self._add(label, value)
        for label, value in values.items():
            if isinstance(value, Marks):
                self._add_marks(label, value)

    def playback(self) -> Playback:
        """Return the playback, thinned to what fits.

        Raises
        ------
        Refusal, ValueError
            If there is nothing to see, or it cannot be drawn.
        """
        if not self._shown and not self._curves:
            raise Refusal(f"name a recording, too: {', '.join(self._values)} is drawn over one")
        if not self._shown:
            self._notes.append("Name a head or model with these shapes, too, to see it move.")
        check_meshes(self._shown.items())
        every = frames_apart([*self._shown.values(), *self._curves.values()])
        panels = [self._panel(label, shown, every) for label, shown in self._shown.items()]
        return Playback(
            panels=tuple(panels),
            every=every,
            notes=(*self._notes, *thinning_notes(every), *out_of_reach(panels)),
            curves=tuple(
                Curves(label=label, weights=thinned_weights(weights, every))
                for label, weights in self._curves.items()
            ),
        )

    def _panel(self, label: str, shown: Trajectories | Animation, every: int) -> Panel:
        if not shown.frames:
            raise Refusal(f"{label} has no frame")
        panel = panel_of(label, thinned(shown, every), AUTO)
        value = self._values[label]
        if not isinstance(value, Trajectories):
            return panel
        return replace(
            panel,
            strip=strip_of(value),
            marks=self._marks.get(label, ()),
            can_be_marked=label not in self._marked_elsewhere,
        )

    @property
    def _recordings(self) -> dict[str, Trajectories]:
        return {k: each for k, each in self._values.items() if isinstance(each, Trajectories)}

    def _add(self, label: str, value: object) -> None:
        if isinstance(value, Trajectories):
            self._shown[label] = self._joined(value)
        elif isinstance(value, Animation):
            self._shown[label], self._curves[label] = value, value.weights
        elif isinstance(value, Weights):
            self._curves[label] = value
        elif isinstance(value, BlendshapeModel):
            self._add_moved(label, value.names, lambda weights: _posed(value, weights))
        elif isinstance(value, Head):
            self._add_moved(
                label, value.names, lambda weights: Animation(head=value, weights=weights)
            )

    def _add_marks(self, label: str, marks: Marks) -> None:
        new = {mark.other for mark in marks.marks if mark.kind == "named"}
        needed = {mark.marker for mark in marks.marks} - new
        beside = [name for name in self._recordings if name + BESIDE == label]
        fitting = [name for name, each in self._recordings.items() if needed <= {*each.markers}]
        taken = next(iter([*beside, *fitting]), None)
        if taken is None:
            self._notes.append(f"{label}: view it with the recording that it marks.")
        else:
            self._marks[taken] = marks.marks
            if not beside:
                self._marked_elsewhere.add(taken)
            self._notes.append(f"{taken} is shown as it is marked in {label}.")

    def _joined(self, recording: Trajectories) -> Trajectories:
        sets = (value for value in self._values.values() if isinstance(value, MarkerSet))
        fitting = next((each for each in sets if set(each.markers) <= {*recording.markers}), None)
        if recording.marker_set is not None or fitting is None:
            return recording
        return replace(recording, marker_set=fitting)

    def _add_moved(
        self,
        label: str,
        names: tuple[str, ...],
        move: Callable[[Weights], Trajectories | Animation],
    ) -> None:
        every = [(name, each) for name, each in self._values.items() if isinstance(each, Weights)]
        for name, weights in every:
            try:
                self._shown[label] = move(weights)
            except ValueError as error:
                self._notes.append(f"{label} does not move as {name} says: {error}.")
            else:
                self._notes.append(f"{label} moves as {name} says.")
                return
        weights = _one_after_another(names)
        self._shown[label] = move(weights)
        if names:
            self._curves[label] = weights
            self._notes.append(f"{label}: its shapes are shown one after the other.")


def _posed(model: BlendshapeModel, weights: Weights) -> Trajectories:
    """Return the markers of a model that weights move.

    Raises
    ------
    ValueError
        If it lacks the shape of a weight.
    """
    shapes = model.shapes[places_of(weights.names, model.names, "model", "shape")]
    offsets = np.tensordot(weights.values, shapes, axes=1)
    return Trajectories(positions=model.neutral + offsets, markers=model.markers, rate=weights.rate)


def _one_after_another(names: tuple[str, ...]) -> Weights:
    """Return weights with which each shape comes and goes by itself; one frame if there is none."""
    rise = np.sin(np.pi * np.arange(_FRAMES) / _FRAMES) ** 2
    values = np.kron(np.eye(len(names)), rise[:, np.newaxis])
    return Weights(values=values if len(names) else np.zeros((1, 0)), names=names, rate=_RATE)
