"""FMUs and the instances of them that a master steps: ours and third-party ones, FMI 2.0 and 3.0."""
