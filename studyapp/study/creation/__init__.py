"""Making and changing a study file from a template."""
