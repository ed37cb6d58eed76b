"""A study: its file, folder, protocol, trial design and stimuli."""
