"""Recordings for Rerun: what its own reader finds in the file."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pyarrow
import pytest
from numpy.typing import NDArray

from nodegraph import Across, NodegraphError, get_node
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.specimens import recordings

SPECIMENS = recordings()
GAPPY, PROCESSED = SPECIMENS["gaps"], SPECIMENS["filled, repaired and with sigma"]


def batches(content: bytes, folder: Path) -> dict[tuple[str, bool], pyarrow.RecordBatch]:
    """Return what a file holds by entity, and whether it holds at all times."""
    (folder / "it.rrd").write_bytes(content)
    from rerun.chunk import RrdReader  # which takes 26 MB

    chunks = RrdReader(folder / "it.rrd").stream().to_chunks()
    return {(chunk.entity_path, chunk.is_static): chunk.to_record_batch() for chunk in chunks}


def column(batch: pyarrow.RecordBatch, name: str) -> list[NDArray[np.float64]]:
    return [np.array(values) for values in batch.column(name).to_pylist()]


@pytest.mark.filterwarnings("ignore:RRD file has no footer")
@pytest.mark.filterwarnings("ignore:the file cannot keep the sigma of 1 recordings")
def test_each_alternative_is_an_entity_without_what_is_missing(tmp_path: Path) -> None:
    write = get_node("write.rrd")
    fills = Across.of({"as it was": GAPPY, "muscle": PROCESSED}, axis="fill")
    content = write(fills, SPECIMENS["complete"]).content["recording.rrd"]
    written = batches(content, tmp_path)
    assert {path for path, _ in written} == {r"/as\ it\ was", "/muscle", "/truth"}
    shown: dict[str, Trajectories] = {r"/as\ it\ was": GAPPY, "/muscle": PROCESSED}
    colours: dict[int, set[int]] = {}
    for path, recording in shown.items():
        points = written[path, False]
        positions, ids, colour = (
            column(points, f"Points3D:{name}") for name in ("positions", "keypoint_ids", "colors")
        )
        for frame, present in enumerate(recording.present):
            np.testing.assert_array_equal(ids[frame], np.flatnonzero(present))
            expected = recording.positions[frame, present].astype(np.float32)
            np.testing.assert_array_equal(positions[frame].reshape(-1, 3), expected)
            for origin, each in zip(recording.origin[frame, present], colour[frame], strict=True):
                colours.setdefault(int(origin), set()).add(int(each))
        seconds = [time.total_seconds() for time in points.column("time").to_pylist()]
        np.testing.assert_allclose(seconds, np.arange(recording.frames) / recording.rate, atol=1e-6)
        context = written[path, True].column("AnnotationContext:context").to_pylist()[0][0][0]
        names = [each["label"] for each in context["class_description"]["keypoint_annotations"]]
        assert tuple(names) == recording.markers
    assert {origin: len(each) for origin, each in colours.items()} == dict.fromkeys(
        (Origin.MEASURED, Origin.FILLED, Origin.REPAIRED), 1
    )
    assert len(set.union(*colours.values())) == 3
    assert write(fills, SPECIMENS["complete"]).content["recording.rrd"] == content


def test_labels_name_entities_once() -> None:
    write = get_node("write.rrd")
    with pytest.raises(ValueError, match="several are labelled truth"):
        write(Across.of({"truth": GAPPY}, axis="fill"))
    with pytest.raises(ValueError, match="there is none"):
        write(Across.of({}, axis="fill"))


def test_without_rerun_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rerun.chunk", None)
    with pytest.raises(NodegraphError, match=r"pip install 'nodegraph\[rerun\]'"):
        get_node("write.rrd")(Across.of({"a": GAPPY}, axis="fill"))
