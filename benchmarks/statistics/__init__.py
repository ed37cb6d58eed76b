"""How fast and how right the statistics are, beside other people's."""
