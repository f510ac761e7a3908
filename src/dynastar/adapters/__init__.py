"""dynastar in other simulators, one module each; each needs the extra of its name."""
