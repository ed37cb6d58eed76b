"""One training run: the loop and its steps, its state, its log and its files."""
