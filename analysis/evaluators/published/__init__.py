"""Published feature networks: the evaluators with which papers computed their FGD."""
