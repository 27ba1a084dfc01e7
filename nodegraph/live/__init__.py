"""Run a graph on a stream, frame by frame: the same nodes, the same results."""
