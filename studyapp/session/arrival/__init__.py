"""Who is let in, and which place they get."""
