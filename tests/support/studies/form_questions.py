"""Questions about participants, for studies of tests; each is a part of a study file."""

ELIGIBILITY = """
[[form.eligibility]]
name = "adult"
text = "Are you 18 or older?"
choices = ["yes", "no"]
eligible = ["yes"]
"""
CONSENT = """
[[form.consent]]
name = "read"
text = "I have read this."
choices = ["yes"]
eligible = ["yes"]
"""
DEMOGRAPHICS = """
[[form.demographics]]
name = "age"
text = "How old are you?"
kind = "number"
low = 18

[[form.demographics]]
name = "work"
text = "What do you work on?"
kind = "text"
required = false
"""
SCALE = """
[[form.demographics]]
name = "often"
text = "How often do you watch animated films?"
kind = "scale"
low = 1
high = 3
choices = ["never", "every day"]
"""
COMPREHENSION = """
[[form.comprehension]]
name = "judged"
text = "What are you to judge?"
choices = ["the clothes", "the gestures"]
eligible = ["the gestures"]
"""
CLOSING = """
[[form.closing]]
name = "comment"
text = "Is there anything you want to tell us?"
kind = "text"
required = false
"""
FORM = ELIGIBILITY + DEMOGRAPHICS + CLOSING
ADULT = {"adult": "yes"}
ABOUT = {"age": "31", "work": ""}
