"""A synthetic corpus: speech and motion with known truth, in the files and folders of BEAT."""
