"""Whether the report's numbers keep their promises: simulated studies with a known truth."""
