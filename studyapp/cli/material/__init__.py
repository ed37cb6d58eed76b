"""The subcommands that make speech, motion and videos, and that train networks."""
