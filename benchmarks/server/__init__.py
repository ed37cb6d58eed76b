"""How fast the study's server is, and what it bears."""
