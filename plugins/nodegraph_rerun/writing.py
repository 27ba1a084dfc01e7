"""Recordings as a file that the viewer Rerun plays, an entity for each."""

from __future__ import annotations

import re
import struct
import warnings
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import Across, Files, NodegraphError, Truth, node
from nodegraph_files.writers import File
from nodegraph_mocap.face_layout import edges_of
from nodegraph_mocap.recording import Origin, Trajectories
from nodegraph_tables.style import BLUE, GREY, ORANGE, VERMILLION

if TYPE_CHECKING:
    from numpy.typing import NDArray

_COLOURS = {Origin.MEASURED: BLUE, Origin.FILLED: VERMILLION, Origin.REPAIRED: ORANGE}
_MOST_MARKERS = 1 << 16
_ID_BYTES = 16

_MAGIC = b"RRF2"
_HEADER = struct.Struct("<4s8x")
_MESSAGE = struct.Struct("<QQ")  # kind, bytes that follow
_END = 0
_ROW_OF_STORE = re.compile(rb"\n\x12\t.{8}\x11.{8}", re.DOTALL)
"""In the message that opens a file, an id of two numbers of 64 bits: a time and a random number."""


@node("write.rrd", shares=File(name="recording"))
def write_rrd(
    recordings: Across[Trajectories],
    truth: Truth[Trajectories] | None = None,
    *,
    file: File,
) -> Files:
    """Write recordings as a file for the viewer Rerun, an entity for each.

    ``rerun recording.rrd`` opens it.

    Each recording is an entity, named by its labels, so that alternatives lie over each other and
    can be shown and hidden. Its points have the markers' names, and lines along the edges of the
    marker set; a measured sample is blue, a filled one vermilion, a repaired one orange, and a
    missing one is not there. The timelines are ``time``, in seconds, and ``frame``, from 0.
    Positions are in millimetres and single precision.

    Parameters
    ----------
    recordings
        One or several.
    truth
        An entity of its own, in grey.

    Returns
    -------
    Files
        One file. The same recordings give the same bytes; therefore it lacks the index that Rerun
        puts at the end in an order of chance, and without which programs read it from the start.
        ``rerun rrd optimize`` adds one.

    Raises
    ------
    ValueError
        If there is no recording, two have the same labels, or one has more than 65,536 markers.
    NodegraphError
        If Rerun is not installed.
    """
    entities = _entities(recordings)
    estimated = sum(recording.sigma is not None for recording in entities.values())
    if estimated:
        warnings.warn(f"the file cannot keep the sigma of {estimated} recordings", stacklevel=3)
    if truth is not None:
        entities["truth"] = truth
    try:
        from rerun.chunk import ChunkStore
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "rerun":
            raise
        raise NodegraphError("write.rrd needs Rerun; pip install 'nodegraph[rerun]'") from error
    chunks = [
        chunk
        for label, recording in entities.items()
        for chunk in _chunks(label, recording, grey=recording is truth)
    ]
    store = ChunkStore.from_chunks(
        [_with_id(chunk, number) for number, chunk in enumerate(chunks, start=1)]
    )
    with TemporaryDirectory() as folder:
        path = Path(folder, "it.rrd")
        store.write_rrd(path, application_id="nodegraph", recording_id=file.name)
        content = _repeatable(path.read_bytes())
    return file.of(".rrd", content)


def _entities(recordings: Across[Trajectories]) -> dict[str, Trajectories]:
    names = [label or "recording" for label in recordings.names()]
    repeated = sorted({label for label in names if names.count(label) > 1 or label == "truth"})
    if not names or repeated:
        what = f"several are labelled {', '.join(repeated)}" if names else "there is none"
        raise ValueError(f"recordings of a file have labels of their own; {what}")
    for label, recording in zip(names, recordings.values(), strict=True):
        if len(recording.markers) > _MOST_MARKERS:
            raise ValueError(
                f"{label}: {len(recording.markers)} markers; Rerun numbers {_MOST_MARKERS}"
            )
    return dict(zip(names, recordings.values(), strict=True))


def _chunks(label: str, recording: Trajectories, *, grey: bool) -> Iterator[object]:
    """Return the names and edges of the markers, and their samples."""
    import rerun
    from rerun.chunk import Chunk

    path = rerun.new_entity_path([label])
    markers = rerun.ClassDescription(
        info=rerun.AnnotationInfo(id=0, label=label),
        keypoint_annotations=[
            rerun.AnnotationInfo(id=number, label=marker)
            for number, marker in enumerate(recording.markers)
        ],
        keypoint_connections=[(first, second) for first, second in edges_of(recording)],
    )
    yield Chunk.from_columns(path, [], rerun.AnnotationContext.columns(context=[markers]))
    present = recording.present
    frames = np.arange(recording.frames)
    yield Chunk.from_columns(
        path,
        [
            rerun.TimeColumn("frame", sequence=frames),
            rerun.TimeColumn("time", duration=frames / recording.rate),
        ],
        rerun.Points3D.columns(
            positions=recording.positions[present],
            colors=_colours(recording.origin[present], grey=grey),
            keypoint_ids=np.nonzero(present)[1],
            class_ids=np.zeros(np.count_nonzero(present), dtype=np.uint16),
        ).partition(np.count_nonzero(present, axis=1)),
    )


def _colours(origin: NDArray[np.uint8], *, grey: bool) -> NDArray[np.uint32]:
    """Return the colour of each sample as a number, 0xRRGGBBAA."""
    table = np.zeros(len(Origin), dtype=np.uint32)
    for each, colour in _COLOURS.items():
        table[each] = int(f"{(GREY if grey else colour).removeprefix('#')}FF", 16)
    return np.asarray(table[origin])


def _with_id(chunk: Any, number: int) -> Any:
    """Return a chunk that is called by its number: Rerun makes names of the time and of chance."""
    import pyarrow
    from rerun.chunk import Chunk

    batch = chunk.to_record_batch()
    metadata = {**batch.schema.metadata, b"rerun:id": f"chunk_{number:032x}".encode()}
    first = number << 64
    rows = [(first + row).to_bytes(_ID_BYTES) for row in range(batch.num_rows)]
    column = pyarrow.array(rows, pyarrow.binary(_ID_BYTES))
    arrays = [
        column if field.name == "rerun.controls.RowId" else batch.column(place)
        for place, field in enumerate(batch.schema)
    ]
    schema = batch.schema.with_metadata(metadata)
    renamed = pyarrow.RecordBatch.from_arrays(arrays, schema=schema)
    return Chunk.from_record_batch(renamed)[0]


def _repeatable(content: bytes) -> bytes:
    """Return a file without what differs from call to call: its index, and the id at its start."""
    if not content.startswith(_MAGIC):
        return content
    at = _HEADER.size
    while (message := _MESSAGE.unpack_from(content, at))[0] != _END:
        at += _MESSAGE.size + message[1]
    body = content[_HEADER.size + _MESSAGE.size : at]
    opening = content[: _HEADER.size + _MESSAGE.size]
    fixed = _ROW_OF_STORE.sub(b"\n\x12\t" + bytes(8) + b"\x11" + bytes(8), body, count=1)
    return opening + fixed + _MESSAGE.pack(_END, 0)
