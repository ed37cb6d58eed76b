"""What the report would conclude from simulated studies, and what is true of them."""
