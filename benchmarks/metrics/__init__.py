"""Speed of metrics, compared with textbook formulas and over many clips."""
