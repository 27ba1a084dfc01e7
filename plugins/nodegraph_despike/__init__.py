"""Find and repair impulses: single samples that are far off."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files

from nodegraph import Contract, hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the nodes that repair impulses."""
    from nodegraph_despike.acceleration import acceleration
    from nodegraph_despike.hampel import hampel
    from nodegraph_despike.impulse import impulse
    from nodegraph_despike.median import median
    from nodegraph_despike.wavelet import wavelet

    return (impulse, hampel, median, acceleration, wavelet)


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the despikers cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every despiker promises."""
    from nodegraph_despike.contracts import CONTRACTS

    return {"despike": CONTRACTS}
