"""Labels of operating points as Datasets: what diagrams, maps and draws are made of."""
