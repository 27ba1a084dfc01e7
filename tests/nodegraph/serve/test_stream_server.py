"""What browsers get of a stream, whatever its length."""

from __future__ import annotations

import json
import pickle
from http.client import HTTPConnection
from urllib.parse import urlsplit

import numpy as np

from nodegraph import Frame
from nodegraph.execute.processes import kill, start
from nodegraph.live.counts import Counts
from nodegraph.live.running_numbers import Latest
from nodegraph.serve.stream_server import Update

MINUTES = 10
EVERY = 0.25


def test_a_line_spans_the_whole_stream_in_few_points() -> None:
    counts = Counts()
    counts.running["error"] = Latest({"rmse": "mm"})
    process = start("nodegraph.serve.stream_server", pipe_output=True)
    try:
        assert process.stdin is not None
        assert process.stdout is not None
        pickle.dump("a page", process.stdin)
        for step in range(round(MINUTES * 60 / EVERY)):
            counts.received = counts.computed = 60 * step
            counts.latencies.add(1_000_000 if step < 2000 else 4_000_000)
            counts.running["error"].receive(Frame(step, 0, 0, np.array([EVERY * step])))
            pickle.dump(Update(EVERY * step, {}, {}, "receiving", "", counts), process.stdin)
        pickle.dump(Update(EVERY * step, {}, {}, "ended", "", counts), process.stdin)
        process.stdin.flush()
        place = urlsplit(process.stdout.readline().decode().strip())
        connection = HTTPConnection(place.netloc)
        connection.request("GET", f"/?{place.query}")
        entered = connection.getresponse()
        entered.read()
        cookie = str(entered.headers["Set-Cookie"]).partition(";")[0]
        connection.request("GET", "/stream", headers={"Cookie": cookie})
        events = connection.getresponse().read().decode().split("data: ")
        connection.close()
        event = json.loads(events[-1])
    finally:
        kill(process)
        process.communicate()
    seconds, values = event["history"]["seconds"], event["history"]["steps"]["error"]["rmse"]
    assert 100 <= len(seconds) <= 300
    assert np.all(np.diff(seconds) > 0)
    assert seconds[-1] - seconds[0] > MINUTES * 60 - 1
    assert np.allclose(values, np.add(seconds, EVERY), atol=0.06)
    figures = event["figures"]
    assert figures["rates"]["in"] == 60 / EVERY
    assert round(figures["latency"]["all"]["p50"]) == 1
    assert round(figures["latency"]["last"]["p50"]) == 4
    assert (figures["state"], figures["numbers"]["received"]) == ("ended", counts.received)
