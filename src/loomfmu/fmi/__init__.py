"""FMI packaging: knows FMI and pythonfmu, and no physics."""
