"""Numbers as papers compute them, for comparison with valid ones, never for conclusions."""
