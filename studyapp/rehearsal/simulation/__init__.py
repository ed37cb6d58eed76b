"""Simulated participants: their population, behaviour and answers."""
