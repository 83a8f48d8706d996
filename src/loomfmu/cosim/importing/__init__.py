"""FMUs and the instances of them that a master steps: ours and other makers', FMI 2.0 and 3.0."""
