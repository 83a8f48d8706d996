"""Live FMUs: what runs a component in the host's Python."""
