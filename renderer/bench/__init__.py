"""How fast videos are made, beside what else could make them; run ``renderer.benchmark``."""
