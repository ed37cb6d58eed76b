"""A body in SMPL-X's file format: its file, skin and face, and the features it cannot show."""
