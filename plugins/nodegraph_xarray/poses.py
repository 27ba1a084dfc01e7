"""Recordings as the datasets of poses that the package ``movement`` works on, and back.

Such a dataset has the dimensions ``time``, ``space``, ``keypoint`` and ``individual``, the
variables ``position`` and ``confidence``, and says with attributes what it holds (``ds_type``) and
at which rate (``fps``, ``time_unit``). Source: documentation of movement 0.17, "The movement
datasets"; before that version, the names ``keypoints`` and ``individuals`` were used.
"""

from __future__ import annotations

import json
import warnings
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import NodegraphError, listed
from nodegraph_files.marker_set import marker_set_of, plain_marker_set
from nodegraph_files.missing import mark_missing
from nodegraph_files.rates import rate_from
from nodegraph_files.units import AUTO, UnitSetting, unit_from
from nodegraph_mocap.recording import Origin, Trajectories

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

_DIMENSIONS = ("time", "space", "keypoint", "individual")
_BEFORE_0_17 = {"keypoints": "keypoint", "individuals": "individual"}
_AXES = ["x", "y", "z"]
_KEPT = {"position", "confidence", "origin", "sigma"}
NAMES = frozenset({*_DIMENSIONS, *_BEFORE_0_17, *_KEPT})
"""Names of the variables and coordinates of a recording."""
_MOST_JITTER = 0.1  # of a frame's duration, by which a step from frame to frame may be off


def to_xarray(recording: Trajectories) -> xarray.Dataset:
    """Return a recording as a dataset of poses of the package ``movement``.

    Beside what ``movement`` expects, the dataset holds what a recording knows: the variables
    ``origin`` (an `Origin` per sample) and, if the recording has it, ``sigma`` (mm), and the
    attribute ``marker_set`` (JSON), so that `from_xarray` returns an equal recording.

    Parameters
    ----------
    recording
        Any.

    Returns
    -------
    xarray.Dataset
        ``position`` (time, space, keypoint, individual) in millimetres, NaN where missing;
        ``confidence`` is NaN, as a recording has none. The only individual is ``id_0``.

    Raises
    ------
    NodegraphError
        If xarray is not installed.
    """
    require_xarray()
    import xarray

    samples = ("time", "keypoint", "individual")
    variables: dict[str, object] = {
        "position": (
            _DIMENSIONS,
            recording.positions.transpose(0, 2, 1)[..., np.newaxis].copy(),
            {"units": "mm"},
        ),
        "confidence": (samples, np.full((*recording.origin.shape, 1), np.nan)),
        "origin": (samples, recording.origin[..., np.newaxis].copy()),
    }
    if recording.sigma is not None:
        variables["sigma"] = (samples, recording.sigma[..., np.newaxis].copy(), {"units": "mm"})
    attributes: dict[str, object] = {
        "source_software": "nodegraph",
        "ds_type": "poses",
        "fps": recording.rate,
        "time_unit": "seconds",
    }
    if recording.marker_set is not None:
        attributes["marker_set"] = json.dumps(plain_marker_set(recording.marker_set))
    coordinates = {
        "time": np.arange(recording.frames) / recording.rate,
        "space": _AXES,
        "keypoint": np.array(recording.markers, dtype=np.str_),
        "individual": ["id_0"],
    }
    return xarray.Dataset(variables, coordinates, attributes)


def from_xarray(
    dataset: xarray.Dataset,
    *,
    individual: str | None = None,
    unit: UnitSetting = AUTO,
    rate: float | None = None,
    zeros_missing: bool = False,
) -> Trajectories:
    """Return the recording that a dataset of poses of the package ``movement`` holds.

    A dataset by `to_xarray` gives an equal recording. What was done to it meanwhile is marked:
    a sample that became NaN is missing, and one that ``origin`` calls missing but has a position
    is filled. Warnings count these, confidences and variables that a recording cannot keep, and
    samples that are partly missing or infinite.

    Parameters
    ----------
    dataset
        With three dimensions of space, of one individual or none; the names of dimensions before
        movement 0.17, ``keypoints`` and ``individuals``, are read as well.
    individual
        Name or number of one of several individuals.
    unit
        Unit of length. By default what ``position.attrs["units"]`` states; if nothing, mm, or cm or
        m where that alone makes the keypoints span 40 to 5000 mm, with a warning.
    rate
        Hz. By default that of the attribute ``fps``, or of the times.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing if there is no ``origin``.

    Returns
    -------
    Trajectories
        In millimetres, a marker per keypoint.

    Raises
    ------
    ValueError
        If it is no dataset of poses in three dimensions, there are several individuals, there is
        no rate, or the times are not evenly spaced.
    NodegraphError
        If xarray is not installed.
    """
    require_xarray()
    import xarray

    if not isinstance(dataset, xarray.Dataset):
        raise TypeError(f"a recording is made of an xarray.Dataset, not of {type(dataset)}")
    poses = _of_individual(_checked(dataset), individual)
    _warn_lost(poses)
    position = poses["position"].sel(space=_AXES).transpose("time", "keypoint", "space")
    positions = _numbers("position", position)
    length = unit_from(unit, str(position.attrs.get("units", "")))
    origin = None
    if "origin" in poses:
        zeros_missing = False
        origin = _samples(poses, "origin")
    markers = _names(poses)
    lost = np.zeros(positions.shape[:2], dtype=np.bool_)
    positions = mark_missing(positions, lost, markers, zeros_missing=zeros_missing)
    length.convert(positions)
    sigma = None
    if "sigma" in poses:
        sigma = _samples(poses, "sigma")
        length.convert(sigma)
    described = poses.attrs.get("marker_set")
    return Trajectories(
        positions=positions,
        markers=markers,
        rate=_rate(poses, rate),
        marker_set=None if described is None else marker_set_of(json.loads(str(described))),
        origin=None if origin is None else _origin(origin, positions),  # type: ignore[arg-type]
        sigma=sigma,
    )


def require_xarray() -> None:
    """Say what to install where xarray is not."""
    try:
        import xarray  # noqa: F401
    except ModuleNotFoundError as error:
        if error.name != "xarray":
            raise
        raise NodegraphError(
            "datasets of movement need xarray; pip install 'nodegraph[xarray]'"
        ) from error


def _checked(dataset: xarray.Dataset) -> xarray.Dataset:
    """Return the dataset with today's names of dimensions and one position per sample."""
    kind = dataset.attrs.get("ds_type", "poses")
    if kind != "poses":
        raise ValueError(f"a dataset of {kind}, but a recording is made of poses")
    if "position" not in dataset:
        there = listed([str(name) for name in dataset.data_vars]) or "nothing"
        raise ValueError(f"no variable position; there is {there}")
    both = [old for old, new in _BEFORE_0_17.items() if {old, new} <= {*dataset.dims}]
    if both:
        raise ValueError(f"dimensions {both[0]} and {_BEFORE_0_17[both[0]]}: only one can be meant")
    poses = dataset.rename({old: new for old, new in _BEFORE_0_17.items() if old in dataset.dims})
    dimensions = set(map(str, poses["position"].dims))
    if dimensions | {"individual"} != set(_DIMENSIONS):
        raise ValueError(
            f"position has the dimensions {', '.join(map(str, dataset['position'].dims))}; a "
            f"recording is made of {', '.join(_DIMENSIONS)}"
        )
    space = [str(axis) for axis in poses["space"].values] if "space" in poses.coords else []
    if sorted(space) != _AXES:
        raise ValueError(
            f"the coordinates of space are {', '.join(space) or 'not named'}; a recording has "
            "three dimensions: x, y, z"
        )
    return poses


def _of_individual(poses: xarray.Dataset, individual: str | None) -> xarray.Dataset:
    if "individual" not in poses.dims:
        return poses
    names = [str(name) for name in poses["individual"].values]
    if individual is None and len(names) != 1:
        raise ValueError(
            f"{len(names)} individuals, and a recording has one: choose "
            f"individual= {listed(names) or 'none'}"
        )
    if individual is not None and names.count(individual) != 1:
        raise ValueError(f"no individual {individual!r}; there is {listed(names)}")
    return poses.isel(individual=0 if individual is None else names.index(individual))


def _warn_lost(poses: xarray.Dataset) -> None:
    others = [str(name) for name in poses.data_vars if name not in _KEPT]
    if others:
        warnings.warn(f"variables that a recording cannot keep: {listed(others)}", stacklevel=3)
    if "confidence" in poses:
        known = int(np.count_nonzero(~np.isnan(_numbers("confidence", poses["confidence"]))))
        if known:
            warnings.warn(
                f"{known} confidences, which a recording cannot keep, are left out; no sample "
                "counts as missing for a low one",
                stacklevel=3,
            )


def _samples(poses: xarray.Dataset, name: str) -> NDArray[np.float64]:
    """Return a variable as (T, M) numbers."""
    variable = poses[name]
    if set(variable.dims) != {"time", "keypoint"}:
        raise ValueError(f"{name} has the dimensions {', '.join(map(str, variable.dims))}")
    return _numbers(name, variable.transpose("time", "keypoint"))


def _numbers(name: str, variable: xarray.DataArray) -> NDArray[np.float64]:
    if variable.dtype.kind not in "fiu":
        raise ValueError(f"{name} is of type {variable.dtype}, and not of numbers")
    return np.array(variable.values, dtype=np.float64, order="C")


def _names(poses: xarray.Dataset) -> tuple[str, ...]:
    if "keypoint" in poses.coords:
        return tuple(str(name) for name in poses["keypoint"].values)
    return tuple(f"keypoint_{place}" for place in range(poses.sizes["keypoint"]))


def _origin(origin: NDArray[np.float64], positions: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return where samples come from, after others may have filled or removed some."""
    if not np.isin(origin, list(Origin)).all():
        raise ValueError(f"origin has numbers other than {', '.join(str(int(o)) for o in Origin)}")
    marked = origin.astype(np.uint8)
    missing = np.isnan(positions[..., 0])
    removed, filled = missing & (marked != Origin.MISSING), ~missing & (marked == Origin.MISSING)
    for changed, what in ((removed, Origin.MISSING), (filled, Origin.FILLED)):
        if changed.any():
            marked[changed] = what
            warnings.warn(
                f"{np.count_nonzero(changed)} samples are {what.name.lower()}, which the origin "
                "does not say yet",
                stacklevel=3,
            )
    return marked


def _rate(poses: xarray.Dataset, setting: float | None) -> float:
    """Return the frames per second, which the times must agree with."""
    frames = poses.sizes["time"]
    times = _numbers("time", poses["time"]) if "time" in poses.coords else np.arange(frames) * 1.0
    counted = "time" not in poses.coords or poses.attrs.get("time_unit") == "frames"
    steps = np.diff(times)
    fps = poses.attrs.get("fps")
    if fps is None and not counted and len(steps):
        fps = 1 / np.median(steps) if np.median(steps) > 0 else None
    number = float(fps) if isinstance(fps, (int, float, np.number)) else np.nan
    stated = number if 0 < number < np.inf else None
    rate = rate_from(setting, stated)
    if rate is None:
        raise ValueError(
            f"no rate: the attribute fps is {fps!r}; set it, or `rate`, to the number of frames "
            "per second"
        )
    spacing = stated or rate
    uneven = ~(np.abs(steps * (1 if counted else spacing) - 1) <= _MOST_JITTER)
    if uneven.any():
        frame = int(np.argmax(uneven)) + 1
        raise ValueError(
            f"the times are not evenly spaced at {spacing:g} Hz: from {times[frame - 1]:g} to "
            f"{times[frame]:g} in frame {frame}, and so {np.count_nonzero(uneven)} of "
            f"{len(steps)} steps; reindex them, or correct the attribute fps"
        )
    return rate
