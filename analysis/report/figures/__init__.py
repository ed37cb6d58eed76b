"""The figures of a report, on matplotlib."""
