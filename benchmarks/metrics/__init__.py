"""Speed of metrics, compared with textbook formulas and on many clips."""
