"""Rendering many videos by processes on one or several hosts."""
