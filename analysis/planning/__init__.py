"""Sample size and power, by simulating the study's own design and tests."""
