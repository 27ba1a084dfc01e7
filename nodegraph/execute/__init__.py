"""Running a plan: calls, executors, the schedule between them, events and results."""
