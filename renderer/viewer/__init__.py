"""Motion in 3D in a browser: compact tracks, and the pages that play them."""
