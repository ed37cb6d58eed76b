"""Data sets as researchers have them: speech and motion, take by take, cut into windows."""
