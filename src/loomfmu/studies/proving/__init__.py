"""`prove`: claims for all shaft angles and all values within ranges, by enclosures of the equations."""

FORMAT = "loomfmu proof 1"  # of certificates
