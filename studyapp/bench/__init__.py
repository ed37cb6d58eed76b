"""Measuring and straining the server, and the PostgreSQL server that it is done with."""
