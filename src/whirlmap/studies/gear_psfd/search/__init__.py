"""The search for the numbers that the paper does not give: what `identify` computes and writes."""
