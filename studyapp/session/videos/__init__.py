"""What a participant may fetch, and what was really played."""
