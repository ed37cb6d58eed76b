"""The study of all three learned systems on the synthetic corpus, and its page."""
