"""Typed graph -> steps: every combination of axes once, in a lean order."""

from nodegraph.plan.planner import plan
from nodegraph.plan.steps import Combination, Gathered, Output, Plan, Step, StepInput, absent_of

__all__ = ["Combination", "Gathered", "Output", "Plan", "Step", "StepInput", "absent_of", "plan"]
