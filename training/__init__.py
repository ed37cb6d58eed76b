"""The training ground: one loop for every network, resumable at any step to the same result."""
