"""Mathematics independent of any mechanism: splines, curves between samples."""
