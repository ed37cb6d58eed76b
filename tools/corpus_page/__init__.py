"""Measurements of a synthetic corpus for the tables of docs/corpus.md."""
