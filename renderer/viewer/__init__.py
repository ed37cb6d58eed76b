"""Motion that one can turn around in a browser: compact tracks, and the pages that play them."""
