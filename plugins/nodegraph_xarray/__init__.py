"""Exchange recordings with ``movement`` as datasets of xarray, in memory and as netCDF files."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from nodegraph import Format, hookimpl

if TYPE_CHECKING:
    from nodegraph_xarray.poses import from_xarray, to_xarray

__all__ = ["from_xarray", "to_xarray"]


def __getattr__(name: str) -> object:
    # a command that exchanges no recording imports nothing of this
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from nodegraph_xarray import poses

    return getattr(poses, name)


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the nodes of this package."""
    from nodegraph_xarray import netcdf

    return (netcdf.write_nc,)


@hookimpl
def nodegraph_formats() -> Iterable[Format]:
    """Return the formats that are read."""
    from nodegraph_xarray import netcdf

    return (netcdf.FORMAT,)
