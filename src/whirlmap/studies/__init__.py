"""Published studies, reproduced and judged."""
