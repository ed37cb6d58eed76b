"""The protocols: for each one module with its keys of `study.toml` and the rules they stand for."""
