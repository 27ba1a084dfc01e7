"""What each command does: one file each, with a function of its name."""
