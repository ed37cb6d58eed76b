"""From stored answers to tables, the report and what is passed on."""
