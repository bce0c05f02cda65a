"""One varied parameter: bifurcation diagrams and waterfalls."""
