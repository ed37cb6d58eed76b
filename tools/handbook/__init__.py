"""What the documentation takes from the program: the commands' options, and what they print."""
