"""From stored answers to tables, the report and shared folders."""
