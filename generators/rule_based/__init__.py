"""Beat gestures from the speech's own energy and pitch, coloured by an emotion."""
