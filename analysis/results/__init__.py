"""From checked answers to the results in `results.json`."""
