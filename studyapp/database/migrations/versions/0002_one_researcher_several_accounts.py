"""A researcher's accounts at a desk and in its studies can be known as one person's."""

import sqlalchemy as sa
from alembic import op

revision = "identity"
down_revision = "first"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add the identity; accounts that are there have none."""
    op.add_column("researchers", sa.Column("identity", sa.String(length=43), nullable=True))
    op.create_index(op.f("ix_researchers_identity"), "researchers", ["identity"], unique=True)


def downgrade() -> None:
    """Take it back."""
    op.drop_index(op.f("ix_researchers_identity"), table_name="researchers")
    op.drop_column("researchers", "identity")
