"""Time and memory for a report of a million answers."""
