"""The protocols: one module each, with its keys of `study.toml` and its trial design."""
