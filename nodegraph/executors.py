"""Public names for plugins that provide an executor.

A plugin returns its executors by name from the hook ``nodegraph_executors``; `Executor` says how
they are called. One that makes each call in this process is short::

    from nodegraph import hookimpl
    from nodegraph.executors import in_time

    def one_by_one(schedule, how):
        while (call := schedule.next()) is not None:
            yield call.step, in_time(schedule.perform, call)

    @hookimpl
    def nodegraph_executors():
        return {"one-by-one": one_by_one}

An executor that has calls made elsewhere hands `side_by_side` a function that makes one call and
returns its outcome; it is called in as many threads as there are calls at a time. For a process
that shares no memory with this one, `CallCodec` encodes a call as a request, `respond` returns the
response there, and `CallCodec` decodes that to an `Outcome`, which ``schedule.keep`` stores.
Requests and responses are lists of buffers. A call that cannot be sent is made by
``schedule.perform``. `in_time` keeps to the time limit of a call. Where a library's threads draw
from Python's `random` beside the calls, `unwatch_random` has no node blamed for that.
"""

from nodegraph.execute.call import Call, perform
from nodegraph.execute.executor import Calls, Executor, HowToRun
from nodegraph.execute.messages import CallCodec, Frame, respond
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.processes import kill, start
from nodegraph.execute.shared_state import unwatch_random
from nodegraph.execute.threads import in_time, side_by_side
from nodegraph.state import State

__all__ = [
    "Call",
    "CallCodec",
    "Calls",
    "Executor",
    "Frame",
    "HowToRun",
    "Outcome",
    "State",
    "in_time",
    "kill",
    "perform",
    "respond",
    "side_by_side",
    "start",
    "unwatch_random",
]
