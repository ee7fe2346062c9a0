"""Which aerodynamics a study uses: the lattice, or a trained surrogate from its file."""

from pathlib import Path

from hera_om.aircraft import Aircraft
from hera_om.aircraft.paths import blank
from hera_om.core.errors import RecordError

LATTICE = "lattice"


def aero_of(aero: str | Path, aircraft: Aircraft):
    """``lattice``, or the SurrogateSet in a file, checked to belong to this aircraft.

    Raises:
        RecordError: the file is damaged, or it was trained on another definition.
    """
    if aero == LATTICE:
        return LATTICE
    from hera_om.studies.training import training_hash
    from hera_om.surrogates import load

    found = load(Path(aero))
    if found.definition_hash != training_hash(aircraft):
        raise RecordError(f"{aero}: the surrogate was trained on another definition than {blank(aircraft).name!r}")
    return found
