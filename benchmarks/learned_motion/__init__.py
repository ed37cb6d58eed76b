"""Learned generators on the synthetic corpus, whose true motion is known."""
