"""Whether automatic metrics order conditions, and clips, as people do."""
