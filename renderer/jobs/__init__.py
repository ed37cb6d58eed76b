"""Rendering many videos: jobs, the processes or hosts that run them, and their outcomes."""
