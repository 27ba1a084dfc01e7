"""How much each axis explains of a metric."""
