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

An executor that makes calls in processes that share no memory with this one encodes each call as
a `Request` by a `CallCodec`, has `respond` return the `Response` there, decodes it to an `Outcome`
here, and hands that to ``schedule.keep``. Requests and responses are lists of buffers. A call that
cannot be sent is encoded as None, and made by ``schedule.perform``. `in_time` keeps to the time
limit of a call.
"""

from nodegraph.execute.call import Call, Outcome, perform
from nodegraph.execute.executor import Executor, HowToRun, Schedule
from nodegraph.execute.numeric_threads import one_thread_here
from nodegraph.execute.threads import in_time
from nodegraph.execute.worker.client import CallCodec, kill, start
from nodegraph.execute.worker.protocol import Frame, Request, Response
from nodegraph.execute.worker.server import respond
from nodegraph.state import State

__all__ = [
    "Call",
    "CallCodec",
    "Executor",
    "Frame",
    "HowToRun",
    "Outcome",
    "Request",
    "Response",
    "Schedule",
    "State",
    "in_time",
    "kill",
    "one_thread_here",
    "perform",
    "respond",
    "start",
]
