"""The player of recordings and animations in a report."""
