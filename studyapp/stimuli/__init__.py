"""From recordings and generators to the videos that participants see."""
