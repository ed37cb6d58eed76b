"""Features of speech for networks."""
