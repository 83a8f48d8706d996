"""Mechanisms from outside the package: read from a file, checked, and held to what their declarations say."""
