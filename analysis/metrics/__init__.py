"""Automatic metrics over motion clips; each has one home and carries its settings."""
