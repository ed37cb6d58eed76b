"""The report's conclusions from simulated studies, compared with the truth."""
