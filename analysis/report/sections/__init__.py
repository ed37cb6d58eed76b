"""The sections of a report around what was found."""
