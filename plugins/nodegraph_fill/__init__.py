"""Fill the gaps of a recording."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files

from nodegraph import Contract, hookimpl


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the fills."""
    from nodegraph_fill.akima import akima
    from nodegraph_fill.bilinear import bilinear
    from nodegraph_fill.burke_lasenby import burke_lasenby
    from nodegraph_fill.cubic import cubic
    from nodegraph_fill.dct import dct
    from nodegraph_fill.dynammo import dynammo
    from nodegraph_fill.gaussian_process import gaussian_process
    from nodegraph_fill.guenter import guenter
    from nodegraph_fill.kriging import kriging
    from nodegraph_fill.lin_ouhyoung import lin_ouhyoung
    from nodegraph_fill.linear import linear
    from nodegraph_fill.muscle import muscle
    from nodegraph_fill.nearest_frames import nearest_frames
    from nodegraph_fill.neighbour_kalman import neighbour_kalman
    from nodegraph_fill.pattern import pattern
    from nodegraph_fill.pca import pca
    from nodegraph_fill.pchip import pchip
    from nodegraph_fill.ppca import ppca
    from nodegraph_fill.ridge import ridge
    from nodegraph_fill.rigid import rigid
    from nodegraph_fill.soft_impute import soft_impute
    from nodegraph_fill.subspace_kalman import subspace_kalman
    from nodegraph_fill.waters import waters

    return (
        akima,
        bilinear,
        burke_lasenby,
        cubic,
        dct,
        dynammo,
        gaussian_process,
        guenter,
        kriging,
        lin_ouhyoung,
        linear,
        muscle,
        nearest_frames,
        neighbour_kalman,
        pattern,
        pca,
        pchip,
        ppca,
        ridge,
        rigid,
        soft_impute,
        subspace_kalman,
        waters,
    )


@hookimpl
def nodegraph_bibtex() -> str:
    """Return what the fills cite."""
    return files(__name__).joinpath("references.bib").read_text(encoding="utf-8")


@hookimpl
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
    """Return what every fill promises."""
    from nodegraph_fill.contracts import CONTRACTS

    return {"fill": CONTRACTS}
