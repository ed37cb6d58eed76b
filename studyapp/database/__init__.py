"""The one room that makes an engine: tables, migrations, copies, scrubbing."""
