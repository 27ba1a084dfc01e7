"""Studies that run on a Dask cluster."""

from tests.executors import away, made_here, registry, same_as_serial, script, study

__all__ = ["away", "made_here", "registry", "same_as_serial", "script", "study"]
