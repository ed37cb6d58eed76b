"""Backups of a study in one file, and bringing a study back from one."""
