"""What the tests of training share."""

from tests.support.short_training import trained_shortly

__all__ = ["trained_shortly"]
