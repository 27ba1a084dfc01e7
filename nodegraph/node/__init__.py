"""Nodes: the decorator, ports, values, and the description of a node."""
