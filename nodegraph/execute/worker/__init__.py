"""Calls in other processes: the messages, the side that sends them, the side that responds."""
