"""Tables and figures travel as what they are: pandas frames and matplotlib figures.

The two names stand for classes of libraries that are slow to import. A type checker sees the
classes themselves; at run time the names recognise them without importing anything.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame as Table
else:

    class _Recognised(type):
        """Recognises the class of a library, if that is imported, in ``isinstance``."""

        def __instancecheck__(cls, value: object) -> bool:
            return cls.__subclasscheck__(type(value))

        def __subclasscheck__(cls, kind: type) -> bool:
            module = sys.modules.get(cls.library)
            known = getattr(module, cls.name, None)
            return type.__subclasscheck__(cls, kind) or (
                known is not None and issubclass(kind, known)
            )

    class Table(metaclass=_Recognised):
        """A pandas DataFrame, a row per unit; `with_info` attaches title, units and the like."""

        library, name = "pandas", "DataFrame"

    class Figure(metaclass=_Recognised):
        """A matplotlib figure."""

        library, name = "matplotlib.figure", "Figure"


__all__ = ["Figure", "Table"]
