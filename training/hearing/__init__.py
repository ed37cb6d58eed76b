"""Speech as networks hear it."""
