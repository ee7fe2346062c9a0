"""OpenMDAO components: each turns the definition into arrays, calls one physics function, and differentiates it."""
