"""Sections that change steadily: decay to rest, growth, drift, a film that thins."""
