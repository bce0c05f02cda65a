"""Trends of sections: decay to rest, growth, drift, a film that thins."""
