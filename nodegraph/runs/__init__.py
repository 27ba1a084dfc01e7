"""Run folders: the record of a run, saved runs, differences between runs, and exports."""
