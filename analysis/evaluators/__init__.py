"""Feature networks: what they see of a clip, how they are trained, and what they say of it.

torch is loaded when a network is, not before.
"""
