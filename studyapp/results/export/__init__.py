"""Exporting a study: tidy tables with a codebook, and a folder for another lab."""
