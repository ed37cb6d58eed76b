"""Motion from points: joints of a body and landmarks of a face."""
