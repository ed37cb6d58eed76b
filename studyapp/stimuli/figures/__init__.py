"""Pictures and videos of motion for a paper."""
