"""Speed and resilience of the study's server."""
