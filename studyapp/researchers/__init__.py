"""Researchers' accounts and roles, what they decide and look at, and the log of it."""
