"""What several commands share: options, ranges, outputs, messages, reports. Nothing here computes a result."""
