"""How fast metrics are, beside the textbook and over many clips."""
