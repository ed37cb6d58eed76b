"""What is computed of the answers while the study goes on, apart from the server's processes."""
