"""Statistics of answers: estimates with honest intervals, tests, and models."""
