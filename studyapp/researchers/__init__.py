"""Researchers' accounts, roles, decisions and looks at results, and the audit log."""
