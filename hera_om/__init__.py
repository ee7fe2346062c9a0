"""Optimisation of distributed-electric-propulsion aircraft: one differentiable OpenMDAO graph."""
