"""A map or a diagram in a browser, and beside it the motion of the point that one clicks. No analysis of its own is here."""
