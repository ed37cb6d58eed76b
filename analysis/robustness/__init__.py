"""Tests that lean on fewer assumptions than the headline, to be read beside it."""
