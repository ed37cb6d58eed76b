"""The live view of a running study, and its alarms."""
