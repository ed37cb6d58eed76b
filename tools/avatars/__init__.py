"""The avatars: Anny, rigged as SMPL-X, dressed, and frozen into one file each."""
