"""Ordered answers: the cumulative link mixed model with crossed random effects."""
