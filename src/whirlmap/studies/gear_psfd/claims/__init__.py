"""The paper's statements, and the labelled diagrams that they are judged on."""
