"""A training run: its loop, steps, state, log and files."""
