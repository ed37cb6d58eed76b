"""Everything that can go wrong before launch: what is looked at, and what is said of it."""
