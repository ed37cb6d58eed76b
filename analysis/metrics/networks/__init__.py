"""Feature networks: what they see of a clip, how they are trained, and what they say of it.

torch is loaded when a network is, not before.
"""

from analysis.metrics.networks.evaluator import Evaluator, load_evaluator

__all__ = ["Evaluator", "load_evaluator"]
