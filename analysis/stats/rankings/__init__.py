"""Rankings of conditions: summaries as papers show them, concordance, and secondary tests."""
