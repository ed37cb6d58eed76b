"""Intervals and tests from drawing again: bootstrap and permutation."""
