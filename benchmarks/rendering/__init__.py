"""How fast videos are made beside what else could make them: ``python -m benchmarks.rendering``."""
