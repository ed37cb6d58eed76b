"""Tables of answers: reading and checking them, response quality, and exclusions."""
