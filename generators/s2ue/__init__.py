"""Speech2UnifiedExpressions: speech to face and body together (Bhattacharya et al. 2024)."""
