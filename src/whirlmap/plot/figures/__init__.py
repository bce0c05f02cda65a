"""Whole figures, composed of panels."""
