"""Measurements of speed and validity; no package and no test imports them."""
