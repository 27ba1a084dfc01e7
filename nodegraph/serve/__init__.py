"""The report of runs on this machine, with everything behind it, for one browser."""
