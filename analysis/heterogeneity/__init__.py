"""Whether an effect is the same for every emotion, segment and speaker."""
