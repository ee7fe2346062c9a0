"""Pure JAX functions of arrays, in SI units and radians; nothing here knows OpenMDAO or a file."""

from hera_om.core import precision

precision.enable()
