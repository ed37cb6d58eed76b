"""Rendering many videos: jobs, the processes or hosts that do them, and their outcomes."""
