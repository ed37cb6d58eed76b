"""How far answers can be relied on: repeated trials, answers all alike, and response times."""
