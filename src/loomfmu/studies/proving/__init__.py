"""`prove`: claims for all shaft angles and all values within ranges, by enclosures of the equations."""

FORMAT = "loomfmu proof 1"  # of certificates
MOST_REVOLUTIONS = 1000  # of a run that a certificate is about: their claims are checked one by one
