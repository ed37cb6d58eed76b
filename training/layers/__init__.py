"""Layers and losses that several networks are made of."""
