"""A body in SMPL-X's file format: its file, its skin, its face, and what it cannot show."""
