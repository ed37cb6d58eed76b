"""Speech: what is heard in it, and speech without a recording."""
