"""Motion representations of networks."""
