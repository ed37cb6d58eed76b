"""Metrics over motions, statistics over responses, and the report that sets them side by side."""
