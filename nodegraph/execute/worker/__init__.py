"""What executors share that compute steps in other processes, on this machine or another."""
