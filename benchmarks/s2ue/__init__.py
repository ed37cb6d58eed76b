"""Speech2UnifiedExpressions measured: how fast it is, and what its ablations cost."""
