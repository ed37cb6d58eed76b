"""Measuring all clips of a study or of folders: reading, scoring, caching and writing."""
