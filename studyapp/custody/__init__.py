"""What becomes of a study's data and its server: backup, restoring, forgetting, deployment."""
