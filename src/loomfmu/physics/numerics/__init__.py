"""Mathematics that knows no mechanism: splines, curves between samples."""
