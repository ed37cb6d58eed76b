"""Measurements of speed and validity; no package imports them."""
