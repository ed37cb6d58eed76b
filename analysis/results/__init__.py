"""From checked answers to the results that `results.json` holds."""
