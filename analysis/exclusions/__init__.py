"""Who is left out of the analysis: named rules, applied in order, each with counts and reasons."""
