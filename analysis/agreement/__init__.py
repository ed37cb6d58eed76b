"""How far participants agree: reported beside the results, never a condition for them."""
