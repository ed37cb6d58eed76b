"""A platform's table of answers: reading it, and saying which of its cells cannot be used."""
