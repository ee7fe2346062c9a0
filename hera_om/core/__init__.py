"""What every layer shares: the registry of variables, errors, precision, provenance."""
