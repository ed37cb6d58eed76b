"""Rendering speed compared with alternatives: ``python -m benchmarks.rendering``."""
