"""Generators of files in this repository: docs pages, message catalogues."""
