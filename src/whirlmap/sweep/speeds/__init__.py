"""Speeds of machines: safe windows, run-up and run-down, designs compared."""
