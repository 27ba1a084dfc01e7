"""Which types of numpy are kept, and under which word; numpy is imported when one is met."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from nodegraph.store import arrays

if TYPE_CHECKING:
    from nodegraph.store.plain import Apart, Together


def is_numpys(kind: type) -> bool:
    """Return whether values of the type are arrays of numpy, or numbers taken from them."""
    if not kind.__module__.startswith("numpy"):
        return False
    import numpy as np

    return kind is np.ndarray or (issubclass(kind, np.generic) and kind.__module__ == "numpy")


def numpys_way(kind: type) -> Callable[[Any, Apart], Any]:
    """Return what takes values of such a type apart."""
    import numpy as np

    def array(value: Any, apart: Apart) -> Any:
        parts, buffer = arrays.array_apart(value)
        return ["array", apart.keep(buffer), *parts]

    if kind is np.ndarray:
        return array
    if kind is np.str_:
        # str() of it would drop zeros at its end
        return lambda value, apart: ["numpy.str", apart.plain("".join(value))]
    if kind is np.bytes_:
        return lambda value, apart: ["numpy.bytes", bytes(value).hex()]
    return lambda value, apart: ["number", *arrays.number_apart(value)]


def _array_again(plain: list[Any], together: Together) -> Any:
    return arrays.array_together(plain[2:], together.buffers[plain[1]])


def _number_again(plain: list[Any], together: Together) -> Any:
    return arrays.number_together(plain[1:])


def _numpys_str(plain: list[Any], together: Together) -> Any:
    import numpy as np

    return np.str_(together.value(plain[1]))


def _numpys_bytes(plain: list[Any], together: Together) -> Any:
    import numpy as np

    return np.bytes_(bytes.fromhex(plain[1]))


NUMPYS: dict[str, Callable[[list[Any], Together], Any]] = {
    "array": _array_again,
    "number": _number_again,
    "numpy.str": _numpys_str,
    "numpy.bytes": _numpys_bytes,
}
