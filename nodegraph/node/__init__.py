"""What a node is: the decorator, ports, values, and the description of a node."""
