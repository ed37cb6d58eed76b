"""Reading data sets: takes of speech and motion, their features, and windows of them."""
