"""A study that ran, as one page that needs nothing else."""
