"""Tables and figures travel as what they are: pandas frames and matplotlib figures.

The two names stand for classes of libraries that are slow to import. A type checker sees the
classes themselves; at run time the names recognise them without importing anything.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame as Table
else:

    class _Recognised(type):
        """Makes ``isinstance`` and ``issubclass`` ask the library, if it is imported at all."""

        def __instancecheck__(cls, value: Any) -> bool:
            return cls.__subclasscheck__(type(value))

        def __subclasscheck__(cls, kind: type) -> bool:
            module = sys.modules.get(cls.library)
            known = getattr(module, cls.name, None)
            return type.__subclasscheck__(cls, kind) or (
                known is not None and issubclass(kind, known)
            )

    class Table(metaclass=_Recognised):
        """A pandas DataFrame, a row per unit.

        ``attrs`` may hold ``title`` (str), ``notes`` (list of str), ``units`` (column: unit) and
        ``better`` (column: which end is the better one, ``lower``, ``higher`` or ``none``); for
        readers, ``answer`` (list of str), ``labels`` (the columns that say which row it is; else
        the first one where it is text), ``best`` (column: the rows whose cells are marked) and
        ``cells`` (column: the names of the columns that are shown within it, as its ``low`` and
        ``high`` ends and its ``p``).
        """

        library, name = "pandas", "DataFrame"

    class Figure(metaclass=_Recognised):
        """A matplotlib figure."""

        library, name = "matplotlib.figure", "Figure"


__all__ = ["Figure", "Table"]
