"""`study.toml`: its sections and their validation."""
