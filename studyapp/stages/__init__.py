"""What the command line does to a study folder, one stage a module."""
