"""Tables of answers: reading and checking them, how they were given, and who is left out."""
