"""Looking at a diagram or map: a point is chosen, and its motion is shown."""
