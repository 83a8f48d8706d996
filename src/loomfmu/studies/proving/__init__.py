"""`prove`: claims for all shaft angles and all values of a box, by enclosures of the components' equations."""
