"""Rehearsing a study: simulated participants with a known taste walk its real pages."""
