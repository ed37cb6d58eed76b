"""One participant, from arrival to completion code."""
