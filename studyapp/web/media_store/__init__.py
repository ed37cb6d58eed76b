"""Videos in an S3-compatible store: participants fetch them there by addresses that expire."""
