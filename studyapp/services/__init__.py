"""What participants and researchers do to the database, one use case a file."""
