"""Translations of the pages, and the tools that keep them complete: ``make messages``."""
