"""What came of a rehearsal: what the analysis finds beside what was put in."""
