"""Planning a study: sample size, power, and pilots."""
