"""Tests that lean on fewer assumptions than the headline, to be read beside it.

Those of participants' means speak of other participants about the same segments: where segments
differ they find too much. min F′ speaks of other segments too.
"""
