"""Generated parts of the documentation: the commands' options and output."""
