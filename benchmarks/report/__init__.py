"""How long a report of a million answers takes."""
