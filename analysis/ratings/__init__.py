"""Ratings of single stimuli: tables as papers show them, contrasts, and sizes of effects."""
