"""Shared parts of the commands: options, ranges, outputs, messages, reports. Nothing here computes a result."""
