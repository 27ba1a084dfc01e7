"""One block of a comparison as a report shows it: the movement of a marker, as methods have it."""
