"""An archive as a file: a zip whose bytes depend on nothing but what goes in."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping

METADATA = "ro-crate-metadata.json"

_LONG_AGO = (1980, 1, 1, 0, 0, 0)
_READABLE = 0o100644 << 16
_UNIX = 3


def packed(files: Mapping[str, bytes], metadata: bytes) -> bytes:
    """Return an archive; equal files give equal bytes."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as file:
        for name, content in {METADATA: metadata, **dict(sorted(files.items()))}.items():
            entry = zipfile.ZipInfo(name, _LONG_AGO)
            entry.compress_type, entry.create_system = zipfile.ZIP_DEFLATED, _UNIX
            entry.external_attr = _READABLE
            file.writestr(entry, content)
    return made.getvalue()
