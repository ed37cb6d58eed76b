"""The only package that creates database engines: tables, migrations, copies, scrubbing."""
