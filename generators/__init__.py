"""Speech to motion: learned models, rule-based baselines, deliberate flaws for catch trials."""
