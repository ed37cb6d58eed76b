"""Programs that generate files of this repository, such as docs pages and message catalogues."""
