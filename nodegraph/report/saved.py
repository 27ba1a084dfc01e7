"""What a report shows, kept beside it, so that the page can be made again without the run."""

from __future__ import annotations

import gzip
import json
import zlib
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.errors import NodegraphError
from nodegraph.report.study import Study

if TYPE_CHECKING:
    from pydantic import TypeAdapter

STUDY = "study.json.gz"


def study_bytes(study: Study) -> bytes:
    """Return a study as compressed JSON, without the files that lie beside the report anyway."""
    sections = tuple(
        replace(one, rendered=replace(one.rendered, files={})) for one in study.sections
    )
    # what failed may name a file whose name is no text: only JSON's own escapes can carry that
    content = json.dumps(_adapter().dump_python(replace(study, sections=sections)))
    return gzip.compress(content.encode(), compresslevel=6, mtime=0)


def read_study(folder: Path) -> Study:
    """Return the study of a run that lies in a folder.

    Raises
    ------
    NodegraphError
        If there is none, or none that this version can read.
    """
    from pydantic import ValidationError

    path = folder / STUDY
    try:
        return _adapter().validate_python(json.loads(gzip.decompress(path.read_bytes())))
    except (FileNotFoundError, NotADirectoryError):
        raise NodegraphError(
            f"{path}: there is no finished run; run the graph, or name the folder of a run"
        ) from None
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        reason = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        raise NodegraphError(f"{path} cannot be read ({reason}); run the graph again") from error
    except (OSError, EOFError, zlib.error, ValueError, RecursionError) as error:
        raise NodegraphError(f"{path} cannot be read ({error}); run the graph again") from error


@cache
def _adapter() -> TypeAdapter[Study]:
    from pydantic import TypeAdapter

    return TypeAdapter(Study)
