"""What each protocol found, in the figures and tables in which its paper shows it."""
