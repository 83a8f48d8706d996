"""Claims on a recorded run, each judged to a verdict on the curve between the samples."""
