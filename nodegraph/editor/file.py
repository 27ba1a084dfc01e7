"""The text of a graph file while it is edited: its history, and the file on the disk."""

from __future__ import annotations

import re
import stat
from pathlib import Path

from nodegraph.editor.merge import merged
from nodegraph.errors import GraphError, NodegraphError, Place, Problem
from nodegraph.graphfile.spec import is_graph_file
from nodegraph.whole_files import write_whole

MOST_BYTES = 4_000_000
"""Bytes of the largest file that is edited."""

_MOST_KEPT = 100_000_000
"""Characters of all earlier texts."""
_LINE = re.compile("[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+")
_MARK = "\ufeff"


class EditedFile:
    """A graph file that is edited.

    What is not saved is kept beside the file, in ``graph.yaml.unsaved``, from the first edit to the
    next time that it is saved; a file that is opened again begins with that.

    Parameters
    ----------
    path
        It need not be there: a new one is empty.

    Attributes
    ----------
    path : Path
    copy : Path
        Where unsaved text is kept.
    text : str
        As in the file, with its line breaks.
    revision : int
        Is another whenever anything here has changed.
    theirs : str or None
        The text on the disk, if it has changed where the text here has as well.
    notice : str
        What has happened to the text that nobody here did; empty for nothing.

    Raises
    ------
    GraphError
        If the file cannot be read, or is too large; or if it is not there and its name is no graph
        file's.
    """

    def __init__(self, path: Path) -> None:
        self.path = path.resolve()
        self.copy = self.path.with_name(f"{self.path.name}.unsaved")
        if not self.path.parent.is_dir():
            raise GraphError([Problem(Place(str(path)), f"there is no folder {self.path.parent}")])
        self._base = _text_in(self.path)
        if self._base is None and not is_graph_file(path.name):
            hint = "a graph file ends in .yaml"
            raise GraphError([Problem(Place(str(path)), "there is no such file", hint)])
        self.text = self._base or ""
        self.revision = 1
        self.theirs: str | None = None
        self.notice = ""
        self._past: list[str] = []
        self._future: list[str] = []
        unsaved = _text_in(self.copy)
        if unsaved is not None and unsaved != self.text:
            self._set(unsaved)
            self.notice = f"begins with the edits in {self.copy.name}, which were not saved"

    @property
    def shown(self) -> str:
        """The text with line feeds alone, as a page has it."""
        return "\n".join(re.split("\r\n|\r|\n", self.text.removeprefix(_MARK)))

    @property
    def is_saved(self) -> bool:
        """Whether the file has the text."""
        return self.text == (self._base or "")

    @property
    def can_undo(self) -> bool:
        """Whether there is an earlier text."""
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        """Whether there is a text that was undone."""
        return bool(self._future)

    def edit(self, shown: str) -> None:
        """Take another text, in which lines that are the same keep their line breaks.

        Raises
        ------
        NodegraphError
            If it cannot be written.
        """
        self.put(self._with_breaks(shown.replace("\r\n", "\n").replace("\r", "\n")))

    def put(self, text: str) -> None:
        """Take another text as it is.

        Raises
        ------
        NodegraphError
            If it cannot be written.
        """
        try:
            size = len(text.encode())
        except UnicodeEncodeError as error:
            raise NodegraphError(f"not text in UTF-8: {error.reason}") from error
        if size > MOST_BYTES:
            raise NodegraphError(f"too large: {size:,} bytes, of {MOST_BYTES:,} at most")
        if text != self.text:
            self._set(text)

    def undo(self) -> None:
        """Return to the text before the last edit, if there is one."""
        self._step(self._past, self._future)

    def redo(self) -> None:
        """Return to the text before the last undo, if there is one."""
        self._step(self._future, self._past)

    def look(self) -> None:
        """Look at the file: what another program has changed is merged, or awaits a choice."""
        theirs = _text_in(self.path)
        if theirs == self._base and self.theirs is not None:
            self.theirs = None
            self._changed("")
        if theirs == self._base or (theirs is not None and theirs == self.theirs):
            return
        name = self.path.name
        if theirs is None:  # it stays here, and can be saved again
            self._base, self.theirs = None, None
            self._changed(f"{name} was removed from the disk")
        elif (text := merged(self._base or "", self.text, theirs)) is not None:
            self._base, self.theirs = theirs, None
            if text != self.text:
                self._set(text)
            self._changed(f"{name} has changed on the disk; its changes are taken over")
        else:
            self.theirs = theirs
            self._changed(f"{name} has changed on the disk in lines that have changed here")

    def take_theirs(self) -> None:
        """Take the text on the disk in place of this; undo brings that back."""
        if self.theirs is not None:
            text, self._base, self.theirs = self.theirs, self.theirs, None
            self._set(text)

    def keep_mine(self) -> None:
        """Let the text here replace that on the disk, once it is saved; undo shows the other."""
        if self.theirs is not None:
            mine, self._base, self.theirs = self.text, self.theirs, None
            self._set(self._base)
            self._set(mine)

    def save(self) -> None:
        """Write the file, whole or not at all.

        Raises
        ------
        NodegraphError
            If it has changed on the disk meanwhile.
        OSError
            If it cannot be written.
        """
        before = self.revision
        self.look()
        if self.theirs is not None or self.revision != before:
            raise NodegraphError(f"not saved: {self.notice}")
        write_whole(self.path, self.text)
        self._base = self.text
        self._turn_to(self.text)

    def _set(self, text: str) -> None:
        self._past.append(self.text)
        while sum(map(len, self._past)) > _MOST_KEPT:
            del self._past[0]
        self._future.clear()
        self._turn_to(text)

    def _step(self, source: list[str], target: list[str]) -> None:
        if source:
            target.append(self.text)
            self._turn_to(source.pop())

    def _turn_to(self, text: str) -> None:
        self.text = text
        self._changed("")
        self._keep()

    def _changed(self, notice: str) -> None:
        self.revision += 1
        self.notice = notice

    def _keep(self) -> None:
        """Keep what is not saved beside the file; remove that once it is."""
        try:
            if self.is_saved:
                self.copy.unlink(missing_ok=True)
            else:
                write_whole(self.copy, self.text)
        except OSError as error:
            self.notice = f"save soon: what is not saved cannot be kept in {self.copy}: {error}"

    def _with_breaks(self, shown: str) -> str:
        """Return a text with the mark and the line breaks of this one."""
        mark = _MARK if self.text.startswith(_MARK) else ""
        breaks = re.findall("\r\n|\r|\n", self.text)
        if "\r" not in self.text:
            return mark + shown
        old, new = _LINE.findall(self.text.removeprefix(mark)), _LINE.findall(shown)
        plain = [re.sub("\r\n|\r", "\n", line) for line in old]
        most = min(len(old), len(new))
        head = next((at for at in range(most) if plain[at] != new[at]), most)
        most -= head
        tail = next((at for at in range(most) if plain[-1 - at] != new[-1 - at]), most)
        between = [line.replace("\n", breaks[0]) for line in new[head : len(new) - tail]]
        return mark + "".join([*old[:head], *between, *old[len(old) - tail :]])


def _text_in(path: Path) -> str | None:
    """Return the text of a file with its line breaks; None if there is none.

    Raises
    ------
    GraphError
        If it cannot be read, or is too large.
    """
    place = Place(str(path))
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise GraphError([Problem(place, "is no regular file")])
        if status.st_size > MOST_BYTES:
            message = f"too large to be edited: {status.st_size:,} bytes"
            raise GraphError([Problem(place, message, f"at most {MOST_BYTES:,}")])
        return path.read_bytes().decode()
    except FileNotFoundError:
        return None
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        byte = error.object[error.start]
        message = f"not text in UTF-8: byte 0x{byte:02x}"
        problem = Problem(Place(str(path), line, 1), message, "save the file in UTF-8")
        raise GraphError([problem]) from error
    except OSError as error:
        raise GraphError([Problem(place, f"cannot be read: {error}")]) from error
