"""Speech2UnifiedExpressions: its speed, and the cost of its ablations."""
