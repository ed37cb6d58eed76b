"""Numbers computed as in papers, only for comparison with valid ones."""
