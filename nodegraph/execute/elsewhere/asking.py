"""Here: calls as questions to other processes, and what their answers come to."""

from __future__ import annotations

import warnings
from dataclasses import replace

from nodegraph.execute.call import Call, Outcome
from nodegraph.execute.elsewhere.address import Address
from nodegraph.execute.elsewhere.letters import INTERRUPTED, LACKING, NOT_SENT, Answer, Question
from nodegraph.execute.elsewhere.surroundings import Surroundings
from nodegraph.execute.schedule import Schedule
from nodegraph.store import Unreadable, Unstorable


class Asker:
    """Turns calls into questions, and answers into outcomes.

    Parameters
    ----------
    schedule
    shares_files
        Whether those who answer see the same files as this process.
    are_new
        Whether they are started for these calls, and so have the code that there is now.
    """

    def __init__(self, schedule: Schedule, *, shares_files: bool, are_new: bool) -> None:
        self._packer = schedule.packer
        self._registry = schedule.plan.graph.registry
        self._shares_files = shares_files
        surroundings = Surroundings.of(self._registry, with_code=not are_new)
        self._surroundings = surroundings.as_bytes()
        self._addresses: dict[int, bytes | None] = {}
        self._told: set[str] = set()

    def question(self, call: Call) -> Question | None:
        """Return a call as a question, or None if it must be made here."""
        address = self._address(call)
        if address is None or self._reads_files(call):
            return None
        try:
            packed = self._packer.pack((dict(call.inputs), dict(call.settings)))
        except Unstorable:
            return None
        if not packed.faithful:
            return None
        return Question(self._surroundings, address, packed.head.encode(), packed.buffers)

    def outcome(self, answer: Answer, who: str) -> Outcome | None:
        """Return what an answer comes to, or None if the call must be made here.

        Parameters
        ----------
        answer
        who
            Who has answered, for what is told to the user.
        """
        if answer.kind == INTERRUPTED:
            raise KeyboardInterrupt
        if answer.kind == NOT_SENT:
            return None
        if answer.differs and answer.differs not in self._told:
            self._told.add(answer.differs)
            warnings.warn(
                f"{who} has {answer.differs}: results may differ in their last digits",
                stacklevel=2,
            )
        if answer.kind == LACKING:
            return replace(answer.outcome, reason=f"{who} {answer.outcome.reason}")
        try:
            values = self._packer.unpack(answer.head.decode(), answer.buffers)
        except Unreadable:
            return None
        return replace(answer.outcome, values=values)

    def _address(self, call: Call) -> bytes | None:
        # by identity: the plan keeps the nodes, and comparing them would read their signatures
        known = id(call.node)
        if known not in self._addresses:
            self._addresses[known] = self._new_address(call)
        return self._addresses[known]

    def _new_address(self, call: Call) -> bytes | None:
        address = Address.of(call, self._registry)
        ports = (*call.node.inputs, *call.node.outputs)
        if address is None or not all(self._packer.travels(port.type) for port in ports):
            return None
        return address.as_bytes()

    def _reads_files(self, call: Call) -> bool:
        return not self._shares_files and any(
            setting.is_file and call.settings.get(name) is not None
            for name, setting in call.node.settings.items()
        )
