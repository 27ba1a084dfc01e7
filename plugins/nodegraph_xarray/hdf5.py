"""Read netCDF-4 in a process of its own: HDF5 may hang in, or crash on, a file that is damaged.

Runs as a program, ``python hdf5.py FILE NAME ...``. It needs nothing of this package, and limits
the time and the memory that it takes by the size of the file.
"""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import h5py
    import xarray

_MOST_INFLATION = 1100
"""Bytes that one of a compressed file may stand for: no more than 1032, by deflate."""
_SMALL = 1 << 24  # bytes, for which there is room in any case
_SECONDS, _BYTES_PER_SECOND = 1, 20e6  # of processor time
_MEMORY, _MEMORY_PER_BYTE = 1 << 28, 3  # bytes


def read_hdf5(path: Path, kept: Collection[str]) -> xarray.Dataset:
    """Return the dataset of a netCDF-4 file, the variables and coordinates `kept` with their data.

    Other variables are 0, and other coordinates left out.

    Raises
    ------
    ValueError
        If it cannot be read, within some seconds of processor time, or refers to another file.
    """
    import xarray

    # by the file of a function, whose code counts for the digest of a node that calls this
    command = [sys.executable, "-P", main.__code__.co_filename, os.path.abspath(path), *kept]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    pipe, nothing = subprocess.PIPE, subprocess.DEVNULL
    with subprocess.Popen(
        command, env=environment, stdin=nothing, stdout=pipe, stderr=nothing
    ) as process:
        stream: Any = process.stdout
        try:
            head = json.loads(stream.readline() or "{}")
            for part in (*head.get("coords", {}).values(), *head.get("data_vars", {}).values()):
                part["data"] = np.empty(part["shape"], part["dtype"])
                stream.readinto(part["data"].reshape(-1).view(np.uint8))
            status = process.wait()
        finally:
            process.kill()
    if status:
        raise ValueError(_reason(status))
    if "error" in head:
        raise ValueError(head["error"])
    for message in head.pop("warnings"):
        warnings.warn(message, stacklevel=3)
    return xarray.Dataset.from_dict(head)


def check_size(dataset: xarray.Dataset, size: int) -> None:
    """Refuse a dataset of more bytes than a file of that size can hold."""
    if dataset.nbytes > max(_MOST_INFLATION * size, _SMALL):
        raise ValueError(f"it announces {dataset.nbytes} bytes, more than it can hold")


def main() -> None:
    """Print a line of JSON that describes the dataset, or the error; then the data."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # HDF5 in a loop is deaf to Python's handler
    path, *kept = sys.argv[1:]
    arrays: list[np.ndarray[Any, Any]] = []
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            dataset = _loaded(path, kept)
        head = dataset.to_dict(data=False) | {"warnings": [str(each.message) for each in caught]}
        for name in (*dataset.coords, *dataset.data_vars):
            values = dataset[name].values
            arrays.append(values if values.dtype.kind in "biufU" else values.astype(np.str_))
            entry = head["coords" if name in dataset.coords else "data_vars"][name]
            entry["dtype"] = arrays[-1].dtype.str
        line = json.dumps(head, default=str)
    except Exception as error:  # of any kind: the libraries trust what a file says
        line, arrays = json.dumps({"error": str(error) or type(error).__name__}), []
    sys.stdout.buffer.write(line.encode() + b"\n")
    for values in arrays:
        sys.stdout.buffer.write(np.ascontiguousarray(values).reshape(-1).view(np.uint8).data)


def _loaded(path: str, kept: Collection[str]) -> xarray.Dataset:
    import h5py
    import xarray

    size = os.stat(path).st_size
    _limit(size)
    with h5py.File(path) as file:
        _check_part(file)
        # beside which h5netcdf would print a traceback of a damaged part
        file.visititems(lambda _, part: _check_part(part))
    with xarray.open_dataset(path, engine="h5netcdf", decode_times=False, cache=False) as dataset:
        others = [name for name in dataset.data_vars if name not in kept]
        few = dataset.drop_vars([name for name in dataset.coords if name not in kept])
        few = few.assign(dict.fromkeys(others, 0))
        check_size(few, size)
        _limit(few.nbytes)
        return few.load()


def _check_part(part: h5py.Group | h5py.Dataset) -> None:
    """Refuse a part whose attributes cannot be read, or that leads to another file."""
    import h5py

    dict(part.attrs)
    if isinstance(part, h5py.Dataset):
        is_outside = part.is_virtual or bool(part.external)
    else:
        links = (part.get(name, getlink=True) for name in part)
        is_outside = any(isinstance(link, h5py.ExternalLink) for link in links)
    if is_outside:
        raise ValueError(f"{part.name} refers to other files; write one file that holds all data")


def _limit(size: int) -> None:
    """Let this process take what so many bytes need, beside what it has taken already."""
    if sys.platform != "linux":
        return
    import resource

    pages = int(Path("/proc/self/statm").read_text().split()[5])  # of data and stack
    most = {
        resource.RLIMIT_CORE: 0.0,
        resource.RLIMIT_CPU: time.process_time() + _SECONDS + size / _BYTES_PER_SECOND,
        resource.RLIMIT_DATA: pages * resource.getpagesize() + _MEMORY + _MEMORY_PER_BYTE * size,
    }
    for kind, value in most.items():
        _, hard = resource.getrlimit(kind)
        limit = math.ceil(value)
        soft = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
        resource.setrlimit(kind, (soft, hard))


def _reason(status: int) -> str:
    if sys.platform == "linux" and status == -signal.SIGXCPU:
        return "it takes far more time than its size explains"
    how = f"by signal {-status}" if status < 0 else f"with status {status}"
    return f"the process that read it ended {how}"


if __name__ == "__main__":
    main()
