"""Groups and problems: they only connect; the variables and constraints of each case stand in tables."""
