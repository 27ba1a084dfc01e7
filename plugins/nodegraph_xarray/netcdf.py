"""Recordings as netCDF files, in which ``movement`` keeps its datasets of poses."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph import Files, Format, node
from nodegraph_files.units import AUTO, UnitSetting
from nodegraph_files.writers import File
from nodegraph_mocap.recording import Trajectories
from nodegraph_xarray.hdf5 import check_size, read_hdf5
from nodegraph_xarray.poses import NAMES, from_xarray, require_xarray, to_xarray

if TYPE_CHECKING:
    import xarray

_CLASSIC = b"CDF"


@node("write.nc", shares=File(name="recording"))
def write_nc(recording: Trajectories, *, file: File) -> Files:
    """Write a recording as netCDF, a dataset of poses of the package movement, bit for bit.

    The dataset is that of `nodegraph_xarray.to_xarray`; ``xarray.open_dataset`` opens it.

    Parameters
    ----------
    recording
        Any.

    Returns
    -------
    Files
        One file, in the classic form of netCDF with offsets of 64 bits.

    Raises
    ------
    NodegraphError
        If xarray is not installed.
    """
    content = bytes(to_xarray(recording).to_netcdf(engine="scipy", format="NETCDF3_64BIT"))
    return file.of(".nc", content)


def read_nc(
    path: Path,
    *,
    zeros_missing: bool = True,
    unit: UnitSetting = AUTO,
    rate: float | None = None,
) -> Trajectories:
    """Read a recording from a netCDF file that holds a dataset of poses; see `from_xarray`.

    A file in the form of netCDF-4 is read in a process of its own, with limits of time and memory.

    Raises
    ------
    ValueError
        With the file, if it is no such file, or keeps data in another one.
    NodegraphError
        If xarray is not installed.
    """
    require_xarray()
    with path.open("rb") as stream:
        is_classic = stream.read(len(_CLASSIC)) == _CLASSIC
    try:
        dataset = _read_classic(path) if is_classic else read_hdf5(path, NAMES)
    except ImportError:
        raise
    except Exception as error:  # of any kind: the libraries trust what a file says
        raise ValueError(f"{path}: not a readable netCDF file: {error}") from None
    try:
        return from_xarray(dataset, unit=unit, rate=rate, zeros_missing=zeros_missing)
    except (ValueError, RecursionError) as error:  # the latter of JSON in an attribute
        raise ValueError(f"{path}: no recording: {error}") from None


def _read_classic(path: Path) -> xarray.Dataset:
    import xarray

    # from memory no more is read than there is, whatever lengths the file announces
    content = path.read_bytes()
    with xarray.open_dataset(
        BytesIO(content), engine="scipy", decode_times=False, cache=False
    ) as dataset:
        check_size(dataset, len(content))
        return dataset.load()


FORMAT = Format("netCDF", Trajectories, (".nc",), read_nc, lambda start: start.startswith(_CLASSIC))
