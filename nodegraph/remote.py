"""Files at an address with their digest: ``https://host/path/file.c3d#sha256=DIGITS``.

An address means the copy of the file in the user's cache folder. Only within `fetching` is
anything downloaded: loading, checking and running a graph connect to nothing.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote, urljoin, urlsplit

from platformdirs import user_cache_path

from nodegraph.errors import NodegraphError
from nodegraph.filenames import portable_name

if TYPE_CHECKING:
    import requests

SCHEMES = ("https", "http", "doi")
MOST_BYTES = 1 << 33
"""Size of the largest file that is fetched."""

_FORM = "write https://HOST/FILE#sha256=DIGITS or doi:10.5281/zenodo.NUMBER/FILE#sha256=DIGITS"
_COMMAND = "`nodegraph fetch` with the name of this graph and the same options"
_LOCAL = "127.0.0.1"
_TIMEOUT = (10.0, 60.0)  # seconds to connect, and between two parts
_PART = 1 << 20

_Outcomes = dict[str, NodegraphError | None]
_outcomes: ContextVar[_Outcomes | None] = ContextVar("outcomes", default=None)
"""The outcome for each address, within `fetching`."""


def is_remote(path: str) -> bool:
    """Return whether a path is an address."""
    return path.partition(":")[0] in SCHEMES


@contextmanager
def fetching() -> Iterator[Mapping[str, NodegraphError | None]]:
    """Fetch what `remote_file` does not find in the cache folder, each address once.

    Yields
    ------
    mapping of address to NodegraphError or None
        Every address so far, with the reason if it could not be fetched.
    """
    outcomes: _Outcomes = {}
    token = _outcomes.set(outcomes)
    try:
        yield outcomes
    finally:
        _outcomes.reset(token)


def remote_file(address: str) -> Path:
    """Return the copy of a file in the cache folder, whose content has the digest.

    Parameters
    ----------
    address
        ``https://...#sha256=...``, or ``doi:PREFIX/SUFFIX/FILE#sha256=...`` for a file of a
        repository that pooch knows, such as Zenodo; also ``http://127.0.0.1``.

    Raises
    ------
    NodegraphError
        If the address is not valid, if the file was not fetched yet, or if it cannot be fetched.
    """
    url, digest = _parts(address)
    name = portable_name(unquote(urlsplit(url).path).rpartition("/")[2] or "file")
    path = user_cache_path("nodegraph") / "files" / digest / name
    outcomes = _outcomes.get()
    if outcomes is not None and address not in outcomes:
        outcomes[address] = _fetch(url, digest, path)
    if outcomes is not None and (error := outcomes[address]) is not None:
        raise error
    if not path.is_file():
        raise NodegraphError(f"{url} has not been fetched; {_COMMAND} does that")
    if _sha256(path) != digest:
        raise NodegraphError(
            f"the copy of {url} was changed after it was fetched: {path}; {_COMMAND} replaces it"
        )
    return path


def _parts(address: str) -> tuple[str, str]:
    """Return the address without its digest, and the digest."""
    url, _, fragment = address.partition("#")
    digest = re.fullmatch(r"sha256=([0-9a-fA-F]{64})", fragment)
    if digest is None:
        raise NodegraphError(
            f"{url} needs the SHA-256 of its content, 64 digits as `sha256sum FILE` prints them: "
            f"{_FORM}"
        )
    if url.startswith("doi:"):
        if not re.fullmatch(r"doi:10\.[\d.]+/[^/\s]+/[^\s]*[^/\s]", url):
            raise NodegraphError(f"{url} is not a DOI with a file of its record: {_FORM}")
    elif reason := _why_refused(url):
        raise NodegraphError(f"{url} {reason}: {_FORM}")
    return url, digest[1].lower()


def _why_refused(url: str) -> str:
    try:
        parts = urlsplit(url)
        host, _ = parts.hostname, parts.port
    except ValueError as error:
        return f"is not an address ({error})"
    if not host:
        return "names no host"
    if parts.username or parts.password:
        return "has a name or password, which would be in every record of the study"
    if parts.scheme == "https" or (parts.scheme == "http" and host == _LOCAL):
        return ""
    return "is not https"


def _sha256(path: Path) -> str:
    status = path.stat()
    return _digest_of(path, status.st_size, status.st_mtime_ns)


@lru_cache
def _digest_of(path: Path, size: int, modified: int) -> str:
    """Return the digest of a file; it is read again when its size or time has changed."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _fetch(url: str, digest: str, path: Path) -> NodegraphError | None:
    """Put a file into the cache folder unless it is there; return why it cannot be."""
    import pooch
    from requests import ConnectionError, RequestException
    from requests.exceptions import SSLError

    pooch.get_logger().setLevel("WARNING")
    try:
        pooch.retrieve(url, f"sha256:{digest}", path.name, path.parent, downloader=_download)
    except (RequestException, OSError, ValueError) as error:
        offline = isinstance(error, ConnectionError) and not isinstance(error, SSLError)
        reason = "there is no connection to its host" if offline else str(error)
        return NodegraphError(f"{url} cannot be fetched: {reason}")
    return None


def _download(url: str, output_file: str, pooch: object) -> None:
    """Download an address into a file, as pooch asks its downloaders to do."""
    import requests

    if url.startswith("doi:"):
        url = _url_of_doi(url.removeprefix("doi:"))
    hooks = {"response": _check_redirect}
    with (
        requests.get(url, stream=True, timeout=_TIMEOUT, hooks=hooks) as response,
        open(output_file, "wb") as file,
    ):
        response.raise_for_status()
        _check_size(int(response.headers.get("content-length", 0)))
        for part in response.iter_content(_PART):
            _check_size(file.tell() + len(part))
            file.write(part)


def _check_size(size: int) -> None:
    if size > MOST_BYTES:
        raise ValueError(f"it is larger than {MOST_BYTES >> 20} MiB")


def _url_of_doi(doi: str) -> str:
    from pooch.downloaders import doi_to_repository

    prefix, suffix, file = doi.split("/", 2)
    url = str(doi_to_repository(f"{prefix}/{suffix}").download_url(file))
    if reason := _why_refused(url):
        raise ValueError(f"its record leads to {url}, which {reason}")
    return url


def _check_redirect(response: requests.Response, **rest: object) -> None:
    if response.is_redirect:
        url = urljoin(response.url, response.headers["location"])
        is_other = urlsplit(url).scheme != urlsplit(response.url).scheme
        reason = "has another scheme" if is_other else _why_refused(url)
        if reason:
            raise ValueError(f"it redirects to {url}, which {reason}")
