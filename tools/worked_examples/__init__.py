"""Numbers as papers compute them, beside the ones to be believed: to compare, never to conclude."""
