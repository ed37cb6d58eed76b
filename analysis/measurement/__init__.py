"""Measuring all clips of a study, or of folders: read, scored, kept and written."""
