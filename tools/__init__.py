"""What makes files of this repository: docs pages, message catalogues."""
