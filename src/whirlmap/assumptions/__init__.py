"""Assumptions of the machine models, and which of them a system or its results violate (`violations.violations`)."""
