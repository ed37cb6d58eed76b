"""The report: one self-contained page that sets answers and metrics side by side."""
