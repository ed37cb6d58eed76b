"""The study: definition, participants, responses, media, rehearsal, and the command line."""
