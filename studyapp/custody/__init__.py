"""Care of a study's data and server: backup, restoring, erasing people, deployment."""
