"""Recordings as netCDF files, in which ``movement`` keeps its datasets of poses."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

from nodegraph import Files, Format, node
from nodegraph_files.units import AUTO, UnitSetting
from nodegraph_files.writers import Name, file_named
from nodegraph_mocap.recording import Trajectories
from nodegraph_xarray.poses import from_xarray, require_xarray, to_xarray

_CLASSIC = b"CDF"
_MOST_INFLATION = 1100
"""Bytes that one of a compressed file may stand for: no more than 1032, by deflate."""
_SMALL = 1 << 24  # bytes, for which there is room in any case


@node("write.nc")
def write_nc(recording: Trajectories, *, name: Name = "recording") -> Files:
    """Write a recording as netCDF, a dataset of poses of the package movement, bit for bit.

    The dataset is that of `nodegraph_xarray.to_xarray`; ``xarray.open_dataset`` opens it.

    Parameters
    ----------
    recording
        Any.
    name
        Of the file, without its suffix.

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
    return file_named(name, ".nc", content)


def read_nc(
    path: Path,
    *,
    zeros_missing: bool = True,
    unit: UnitSetting = AUTO,
    rate: float | None = None,
) -> Trajectories:
    """Read a recording from a netCDF file that holds a dataset of poses; see `from_xarray`.

    Raises
    ------
    ValueError
        With the file, if it is no such file.
    NodegraphError
        If xarray is not installed.
    """
    require_xarray()
    import xarray

    with path.open("rb") as stream:
        is_classic = stream.read(len(_CLASSIC)) == _CLASSIC
    # from memory no more is read than there is, whatever lengths a classic file announces
    source, engine = (BytesIO(path.read_bytes()), "scipy") if is_classic else (path, "h5netcdf")
    try:
        if not is_classic:
            _visit(path)
        with xarray.open_dataset(source, engine=engine, decode_times=False, cache=False) as dataset:
            if dataset.nbytes > max(_MOST_INFLATION * path.stat().st_size, _SMALL):
                raise ValueError(f"it announces {dataset.nbytes} bytes, more than it can hold")
            dataset.load()
    except ImportError:
        raise
    except Exception as error:  # of any kind: the libraries trust what a file says
        raise ValueError(f"{path}: not a readable netCDF file: {error}") from None
    try:
        return from_xarray(dataset, unit=unit, rate=rate, zeros_missing=zeros_missing)
    except ValueError as error:
        raise ValueError(f"{path}: no recording: {error}") from None


def _visit(path: Path) -> None:
    """Raise the error of a damaged HDF5 file, beside which h5netcdf would print a traceback."""
    import h5py

    def look(name: str, part: h5py.Group | h5py.Dataset) -> None:
        dict(part.attrs)

    with h5py.File(path) as file:
        look("/", file)
        file.visititems(look)


FORMAT = Format("netCDF", Trajectories, (".nc",), read_nc, lambda start: start.startswith(_CLASSIC))
