"""System packages (SSP 1.0): scenes written as such, and read from them."""
