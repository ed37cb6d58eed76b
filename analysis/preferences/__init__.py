"""Means of answers of the same participants about the same segments, with honest intervals."""
