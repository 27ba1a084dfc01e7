"""The part of an address after the scheme: ``127.0.0.1:39539?rate=60``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from urllib.parse import parse_qsl

from nodegraph import NodegraphError, listed

HOST = "127.0.0.1"
EVERY_HOST = "0.0.0.0"


class Settings:
    """The settings behind the question mark of an address: numbers above zero.

    Parameters
    ----------
    scheme
        For messages.
    text
        The part after the scheme.
    form
        How the whole address is written, for messages.
    defaults
        The settings that there are.

    Attributes
    ----------
    before : str
        The part before the question mark.

    Raises
    ------
    NodegraphError
        If a setting is unknown or no number above zero.
    """

    def __init__(self, scheme: str, text: str, form: str, defaults: Mapping[str, float]) -> None:
        self.address = f"{scheme}:{text}"
        self.before, _, query = text.partition("?")
        self._form = form
        self._numbers = dict(defaults)
        for name, value in parse_qsl(query, keep_blank_values=True):
            if name not in defaults:
                raise self.error(f"no setting {name!r}; there is {listed(defaults)}")
            self._numbers[name] = self._number(name, value)

    def __getitem__(self, name: str) -> float:
        return self._numbers[name]

    def error(self, reason: str) -> NodegraphError:
        """Return an error that names the address and says how it is written."""
        return NodegraphError(f"{self.address}: {reason}; expected {self._form}")

    def endpoint(self, port: int) -> tuple[str, int]:
        """Return host and port; without them, this machine and the protocol's usual port.

        Raises
        ------
        NodegraphError
            If the port is not a number from 1 to 65535.
        """
        text = self.before.removeprefix("//").removesuffix("/")
        host, colon, written = text.rpartition(":")
        if not colon:
            # a number alone is a port
            host, written = ("", text) if text.isdecimal() else (text, str(port))
        is_short = written.isascii() and written.isdecimal() and len(written) <= 5
        if not (is_short and 0 < int(written) < 65536):
            raise self.error(f"{written!r} is not a port from 1 to 65535")
        return host or HOST, int(written)

    def _number(self, name: str, value: str) -> float:
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if not 0 < number < math.inf:
            raise self.error(f"{name} is a number above 0, not {value!r}")
        return number
