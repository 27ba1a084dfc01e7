from __future__ import annotations

import io
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.colors import to_hex, to_rgba
from matplotlib.figure import Figure as MatplotlibFigure

from nodegraph import Across, Refusal
from nodegraph_mocap import Selection, Trajectories
from nodegraph_mocap.view import frontal
from nodegraph_plot.selection import selection
from nodegraph_tables.style import GREY
from tests.plugins.nodegraph_plot import made_face

PAIRS = (("brow_l", "brow_r"), ("mouth_l", "mouth_r"), ("nose",))
SHARES = np.array([0.25, 1.0, 0.5])


def chosen(*names: str, with_shares: bool = True) -> Selection:
    frequencies = SHARES if with_shares else None
    return Selection(chosen=names, pairs=PAIRS, frequencies=frequencies)


def swept() -> Across[Selection]:
    """Two actors, two sizes."""
    entries: list[Any] = [
        ({"actor": actor, "k": k}, chosen(*names))
        for actor in ("ME", "JZ")
        for k, names in ((1, ("nose",)), (2, ("nose", "mouth_l", "mouth_r")))
    ]
    return Across(("actor", "k"), tuple(entries))


def recordings(*actors: str) -> Across[Trajectories]:
    return Across.of({actor: made_face.truth() for actor in actors}, axis="actor")


def alone(first: Selection, recording: Trajectories) -> Any:
    figure = selection(Across((), (({}, first),)), Across((), (({}, recording),)))
    return figure.axes[0]


def dots(axis: Axes) -> dict[str, PathCollection]:
    return {
        str(artist.get_label()): artist
        for artist in axis.collections
        if isinstance(artist, PathCollection)
    }


def titles(figure: MatplotlibFigure) -> list[str]:
    return [axis.get_title() for axis in figure.axes if axis.get_title()]


def test_chosen_markers_are_filled_and_others_hollow_at_their_mean_places() -> None:
    recording = made_face.truth()
    axis = alone(chosen("nose", "mouth_l", "mouth_r"), recording)
    places = frontal(recording, "auto").project(recording.positions.mean(axis=0))
    full = np.isin(recording.markers, ("nose", "mouth_l", "mouth_r"))
    drawn = dots(axis)
    assert np.asarray(drawn["chosen"].get_offsets()) == pytest.approx(places[full])
    assert np.asarray(drawn["not chosen"].get_offsets()) == pytest.approx(places[~full])
    assert len(np.asarray(drawn["chosen"].get_facecolor())) == 3
    assert not len(np.asarray(drawn["not chosen"].get_facecolor()))
    assert axis.get_title() == "3 of 9 markers (33 %)"


def test_the_colour_is_the_share_of_the_pair_and_grey_where_it_is_not_known() -> None:
    axis = alone(chosen("nose", "mouth_l", "mouth_r"), made_face.truth())
    scale = colormaps["viridis_r"]
    full = np.asarray(dots(axis)["chosen"].get_facecolor())
    assert full == pytest.approx(np.array([scale(0.5), scale(1.0), scale(1.0)]))
    hollow = np.asarray(dots(axis)["not chosen"].get_edgecolor())
    known = {"brow_l": scale(0.25), "brow_r": scale(0.25)}
    others = [name for name in made_face.MARKERS if name not in ("nose", "mouth_l", "mouth_r")]
    expected = [known.get(name, to_rgba(GREY)) for name in others]
    assert hollow == pytest.approx(np.array(expected))
    assert [panel.get_ylabel() for panel in axis.figure.axes[1:]] == [
        "share of the runs that chose the pair"
    ]


def test_without_frequencies_there_is_no_colour_bar() -> None:
    axis = alone(chosen("nose", with_shares=False), made_face.truth())
    assert len(axis.figure.axes) == 1
    assert to_hex(np.asarray(dots(axis)["chosen"].get_facecolor())[0]).upper() == GREY


def test_every_selection_has_a_face_on_the_recording_of_its_actor() -> None:
    figure = selection(swept(), recordings("ME", "JZ"))
    assert titles(figure) == [
        "ME, k 1\n1 of 9 markers (11 %)",
        "ME, k 2\n3 of 9 markers (33 %)",
        "JZ, k 1\n1 of 9 markers (11 %)",
        "JZ, k 2\n3 of 9 markers (33 %)",
    ]
    sizes = {
        tuple(np.ptp(panel.get_xlim() + panel.get_ylim()) for _ in "1") for panel in figure.axes[:4]
    }
    assert len(sizes) == 1


def test_the_best_rows_say_which_are_drawn_in_their_order() -> None:
    best = pd.DataFrame({"actor": ["JZ", "ME", "JZ"], "k": [2, 1, 2], "markers": [3, 1, 3]})
    assert titles(selection(swept(), recordings("ME", "JZ"), best)) == [
        "JZ, k 2\n3 of 9 markers (33 %)",
        "ME, k 1\n1 of 9 markers (11 %)",
    ]
    of_an_actor = selection(swept(), recordings("ME", "JZ"), best[["actor"]].iloc[:1])
    assert [text.partition("\n")[0] for text in titles(of_an_actor)] == ["JZ, k 1", "JZ, k 2"]


def test_nothing_marked_is_refused() -> None:
    with pytest.raises(Refusal, match="nothing is marked"):
        selection(swept(), recordings("ME", "JZ"), pd.DataFrame({"actor": [], "k": []}))


def test_best_must_name_selections_that_are_there() -> None:
    with pytest.raises(ValueError, match=r"best names JZ, k 3, .* there are: ME, 1; ME, 2"):
        selection(swept(), recordings("ME"), pd.DataFrame({"actor": ["JZ"], "k": [3]}))
    with pytest.raises(ValueError, match="axes: actor, k; columns: markers"):
        selection(swept(), recordings("ME"), pd.DataFrame({"markers": [3]}))


def test_a_selection_needs_one_recording_that_has_its_markers() -> None:
    with pytest.raises(ValueError, match=r"no recordings belong to the selection JZ, k 1.*1: ME"):
        selection(swept(), recordings("ME"))
    twice = Across.of({0: made_face.truth(), 1: made_face.truth()}, axis="k")
    with pytest.raises(ValueError, match="no recordings belong to the selection ME, k 2"):
        selection(swept(), twice)
    with pytest.raises(ValueError, match=r"lacks what is selected: mouth_l, mouth_r"):
        alone(chosen("nose", "mouth_l", "mouth_r"), made_face.truth().keep(["nose", "chin"]))
    with pytest.raises(ValueError, match="the recording has no markers: there is nothing to draw"):
        alone(chosen(), made_face.truth().keep(()))
    with pytest.raises(ValueError, match="no selection to draw"):
        selection(Across(("k",), ()), recordings("ME"))


def test_labels_with_markup_are_drawn_as_they_are() -> None:
    figure = selection(
        Across.of({"$x^$": chosen("nose")}, axis="actor"), recordings("$x^$", "other")
    )
    file = io.BytesIO()
    figure.savefig(file, format="svg")
    assert titles(figure)[0].startswith(r"\$x^\$")
