"""Motion as networks tell it."""
