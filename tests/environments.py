"""Wheels that are built from a tree, and virtual environments to install them into."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

ROOT = Path(__file__).parents[1]
BIN = "Scripts" if os.name == "nt" else "bin"
_HIDDEN = {"PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV"}


@dataclass(frozen=True)
class Environment:
    """A virtual environment with the libraries that this one has, but without nodegraph.

    Attributes
    ----------
    folder : Path
        Has the environment, and a home and a store of its own.
    """

    folder: Path

    @classmethod
    def create(cls, folder: Path) -> Environment:
        """Create one in a folder, without downloads."""
        created = cls(folder)
        venv.create(folder / "venv", with_pip=False, symlinks=os.name != "nt")
        libraries = folder / "libraries" / "site-packages"  # by that name they are installed
        libraries.mkdir(parents=True)
        for installed in {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}:
            for path in Path(installed).iterdir():
                if not path.name.startswith("nodegraph"):
                    (libraries / path.name).symlink_to(path)
        (created.site_packages / "libraries.pth").write_text(str(libraries))
        return created

    @property
    def python(self) -> Path:
        """The interpreter."""
        return self.folder / "venv" / BIN / "python"

    @property
    def home(self) -> Path:
        """The home of who uses it."""
        return self.folder / "home"

    @property
    def site_packages(self) -> Path:
        """The folder that pip installs into."""
        base = str(self.folder / "venv")
        return Path(sysconfig.get_path("purelib", "venv", {"base": base}))

    def files(self) -> set[Path]:
        """Return all that was installed, but for what Python compiles."""
        return {path for path in self.site_packages.rglob("*") if "__pycache__" not in path.parts}

    def install(self, *words: str | Path) -> None:
        """Install with pip, which downloads nothing.

        Python compiles the modules that programs import, and pip would compile all others, too.
        """
        offline = ("--no-deps", "--no-build-isolation", "--no-index")
        self._pip("install", "--no-compile", *offline, *map(str, words))

    def uninstall(self, name: str) -> None:
        """Uninstall with pip."""
        self._pip("uninstall", "-y", name)

    def run(self, program: str, *words: str | Path) -> str:
        """Run a program of the environment, which must succeed, and return what it prints."""
        path = self.python.with_name(program)
        variables = {
            "HOME": str(self.home),
            "XDG_CACHE_HOME": str(self.home / ".cache"),
            "NUMBA_CACHE_DIR": "",
            "NODEGRAPH_STORE": str(self.folder / "store"),
        }
        return run(str(path), *map(str, words), cwd=self.folder, variables=variables).stdout

    def _pip(self, *words: str) -> None:
        pip = (sys.executable, "-m", "pip", "--python", str(self.python))
        run(*pip, "--quiet", "--disable-pip-version-check", *words)


def build(source: Path, out: Path, *what: str) -> Path:
    """Build an sdist and a wheel from it, or what is named, and return the folder."""
    command = (sys.executable, "-m", "build", "--no-isolation", "--outdir", str(out))
    run(*command, *what, str(source))
    return out


def one_wheel(folder: Path, name: str) -> Path:
    """Return the only wheel of a name in a folder."""
    (wheel,) = folder.glob(f"{name}-*.whl")
    return wheel


def run(
    *words: str, cwd: Path | None = None, variables: Mapping[str, str] = MappingProxyType({})
) -> subprocess.CompletedProcess[str]:
    """Run a command without this process's import path; it must succeed.

    Parameters
    ----------
    *words
    cwd
        The working directory.
    variables
        Of the environment, beside those of this process.
    """
    kept = {name: value for name, value in os.environ.items() if name not in _HIDDEN}
    environment = {**kept, **variables}
    done = subprocess.run(words, cwd=cwd, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, f"{' '.join(words)}\n{done.stdout}\n{done.stderr}"
    return done
