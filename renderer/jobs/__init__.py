"""Many videos: what is to be made, by which processes or hosts, and what became of it."""
