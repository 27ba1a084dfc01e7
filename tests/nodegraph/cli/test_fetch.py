"""Files named by address and digest are fetched once, by one command, and then are files."""

from __future__ import annotations

import hashlib
import shutil
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest
import yaml

from nodegraph import remote
from tests.texts import edit

from . import frozen
from .conftest import Command

OTHER = "0" * 64


@dataclass
class Host:
    """A server on this machine.

    Attributes
    ----------
    port : int
    files : dict of path to bytes
    moved : dict of path to address
    sized : dict of path to the size that it claims, without a body
    paths : list of paths
        Those that were requested.
    """

    port: int
    files: dict[str, bytes] = field(default_factory=dict)
    moved: dict[str, str] = field(default_factory=dict)
    sized: dict[str, int] = field(default_factory=dict)
    paths: list[str] = field(default_factory=list)

    def address(self, path: str, digest: str = "") -> str:
        content = self.files.get(path, b"")
        return f"{self.url(path)}#sha256={digest or hashlib.sha256(content).hexdigest()}"

    def url(self, path: str) -> str:
        return f"http://127.0.0.1:{self.port}{path}"


@pytest.fixture
def host(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Host]:
    """The numbers of the study on a server, and a cache folder of its own."""
    monkeypatch.setattr(remote, "user_cache_path", lambda name: tmp_path / "cache" / name)
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    frozen.write_study()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            here.paths.append(self.path)
            content = here.files.get(self.path, b"")
            if self.path in here.moved:
                self.send_response(302)
                self.send_header("Location", here.moved[self.path])
            else:
                self.send_response(200 if content or self.path in here.sized else 404)
            if self.path in here.sized:
                self.send_header("Content-Length", str(here.sized[self.path]))
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *words: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        here = Host(server.server_port, {"/data/numbers.txt": Path("numbers.txt").read_bytes()})
        Thread(target=server.serve_forever, args=(0.01,)).start()
        yield here
        server.shutdown()


@pytest.fixture
def study(command: Command) -> Command:
    """Run one command with the nodes of the study."""
    return lambda *words: command(*words, "--plugin", "study.py", nodes=False)


def use(address: str) -> None:
    edit("study.yaml", "{file: numbers.txt}", f'{{file: "{address}"}}')


def test_nothing_is_fetched_but_by_the_command_for_it(host: Host, study: Command) -> None:
    use(host.address("/data/numbers.txt"))
    for words in (["check", "study.yaml"], ["run", "study.yaml"], ["lock", "study.yaml"]):
        status, _, err = study(*words)
        assert status == 2
        assert "study.yaml:6:" in err
        assert "numbers.txt has not been fetched; `nodegraph fetch` with the name" in err
    assert not host.paths
    status, out, _ = study("fetch", "study.yaml")
    assert (status, out) == (0, f"here: {host.address('/data/numbers.txt')}\n")
    assert study("fetch", "study.yaml")[0] == 0
    assert host.paths == ["/data/numbers.txt"]


def test_a_fetched_file_counts_as_the_same_file_elsewhere(host: Host, study: Command) -> None:
    assert study("run", "study.yaml")[0] == 0
    more = ("--set", f"file={host.address('/data/numbers.txt')}")
    assert study("fetch", "study.yaml", *more)[0] == 0
    status, out, _ = study("run", "study.yaml", *more)
    assert status == 0
    assert "10 stored" in out


def test_lock_and_archive_hold_the_address(
    host: Host, study: Command, command: Command, tmp_path: Path
) -> None:
    address = host.address("/data/numbers.txt")
    use(address)
    study("fetch", "study.yaml")
    assert study("run", "study.yaml")[0] == 0
    assert study("lock", "study.yaml")[0] == 0
    text = Path("study.lock").read_text()
    assert yaml.safe_load(text)["files"][address].startswith(address[-64:])
    assert str(tmp_path) not in text
    assert command("archive", "runs/study", nodes=False)[0] == 0
    with zipfile.ZipFile("runs/study.zip") as archive:
        assert archive.read("study.yaml") == Path("study.yaml").read_bytes()
        readme = archive.read("README.md").decode()
        assert "numbers.txt" not in {Path(name).name for name in archive.namelist()}
    assert "    nodegraph fetch study.yaml --plugin" in readme
    assert f"- `{address}`, to be fetched from there: {address[-64:]}.txt" in readme

    shutil.rmtree("cache")
    status, _, err = study("verify", "study.lock")
    assert status == 2
    assert "has not been fetched" in err
    assert study("fetch", "study.lock")[0] == 0
    assert study("verify", "study.lock")[1].startswith("identical")


def test_only_what_the_command_chooses_is_fetched(host: Host, study: Command) -> None:
    host.files["/other.txt"] = b"1 2 3\n4 5 6"
    addresses = f'a: "{host.address("/data/numbers.txt")}", b: "{host.address("/other.txt")}"'
    axis = ("--axis", f"file={{{addresses}}}")
    assert study("fetch", "study.yaml", *axis, "--only", "file=b")[0] == 0
    assert host.paths == ["/other.txt"]


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("/missing.txt", "404"),
        ("/wrong.txt", "does not match"),
        ("/to-https", "redirects to https://127.0.0.1/x, which has another scheme"),
        ("/to-file", "redirects to file:///etc/passwd, which has another scheme"),
        ("/to-afar", "redirects to http://a.invalid/x, which is not https"),
        ("/huge", "it is larger than 8192 MiB"),
        ("/endless", "it is larger than 8192 MiB"),
    ],
)
def test_what_cannot_be_fetched_says_why_and_leaves_nothing(
    host: Host, study: Command, monkeypatch: pytest.MonkeyPatch, path: str, expected: str
) -> None:
    host.files |= {"/wrong.txt": b"0", "/endless": b"0" * 2000}
    host.moved = {
        "/to-https": "https://127.0.0.1/x",
        "/to-file": "file:///etc/passwd",
        "/to-afar": "http://a.invalid/x",
    }
    host.sized = {"/huge": remote.MOST_BYTES + 1}
    if path == "/endless":  # a server that tells no size
        monkeypatch.setattr(remote, "MOST_BYTES", 1000)
        expected = "it is larger than 0 MiB"
    use(host.address(path, OTHER))
    status, out, err = study("fetch", "study.yaml")
    assert status == 2
    assert out.startswith("not fetched: ")
    assert "study.yaml:6:" in err
    assert expected in err
    assert host.paths == [path]
    assert not [file for file in Path("cache").rglob("*") if file.is_file()]


def test_a_copy_that_was_changed_is_refused_until_it_is_fetched_again(
    host: Host, study: Command
) -> None:
    use(host.address("/data/numbers.txt"))
    study("fetch", "study.yaml")
    (copy,) = Path("cache").rglob("numbers.txt")
    copy.write_text("1 2 3")
    status, _, err = study("run", "study.yaml")
    assert status == 2
    assert "was changed after it was fetched" in err
    assert study("fetch", "study.yaml")[0] == 0
    assert study("run", "study.yaml")[0] == 0


@pytest.mark.parametrize(
    ("address", "expected"),
    [
        ("https://a.invalid/x.txt", "needs the SHA-256 of its content"),
        ("https://a.invalid/x.txt#sha256=12", "needs the SHA-256 of its content"),
        (f"http://a.invalid/x#sha256={OTHER}", "is not https"),
        (f"https://me:word@a.invalid/x#sha256={OTHER}", "has a name or password"),
        (f"https:/x#sha256={OTHER}", "names no host"),
        (f"https://a.invalid:x/y#sha256={OTHER}", "is not an address"),
        (f"doi:10.5281/zenodo.1#sha256={OTHER}", "is not a DOI with a file of its record"),
    ],
)
def test_an_address_that_is_not_valid_is_explained(
    host: Host, study: Command, address: str, expected: str
) -> None:
    use(address)
    status, _, err = study("fetch", "study.yaml")
    assert status == 2
    assert expected in err


def test_a_doi_leads_to_a_file_of_its_record(
    host: Host, study: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Record:
        def download_url(self, file: str) -> str:
            return host.url(f"/data/{file}")

    records = {"10.5281/zenodo.1": Record()}
    monkeypatch.setattr("pooch.downloaders.doi_to_repository", records.__getitem__)
    digest = hashlib.sha256(host.files["/data/numbers.txt"]).hexdigest()
    use(f"doi:10.5281/zenodo.1/numbers.txt#sha256={digest}")
    assert study("fetch", "study.yaml")[0] == 0
    assert study("run", "study.yaml")[0] == 0


def test_a_graph_without_addresses_has_nothing_to_fetch(command: Command) -> None:
    status, _, err = command("fetch", "toy.yaml")
    assert status == 0
    assert "names no file by its address" in err
