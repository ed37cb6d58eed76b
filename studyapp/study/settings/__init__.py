"""`study.toml`: every section of it, checked."""
