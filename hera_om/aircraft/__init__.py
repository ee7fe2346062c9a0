"""What an aircraft is: the typed definition, TOML in and out, its numbers by path."""

from hera_om.aircraft.definition import Aircraft as Aircraft
from hera_om.aircraft.fields import Part as Part
from hera_om.aircraft.io import definition_hash as definition_hash
from hera_om.aircraft.io import dumps as dumps
from hera_om.aircraft.io import load_aircraft as load_aircraft
from hera_om.aircraft.io import loads as loads
from hera_om.aircraft.io import shipped as shipped
from hera_om.aircraft.paths import VariableBox as VariableBox
from hera_om.aircraft.paths import blank as blank
from hera_om.aircraft.paths import fill as fill
from hera_om.aircraft.paths import numbers as numbers
from hera_om.aircraft.paths import replace_numbers as replace_numbers
from hera_om.aircraft.paths import unit_of as unit_of
from hera_om.aircraft.paths import variable_box as variable_box
from hera_om.aircraft.reference import reference_b as reference_b
from hera_om.aircraft.reference import reference_c as reference_c
from hera_om.aircraft.reference import reference_S as reference_S
from hera_om.aircraft.rotors import hub_ys as hub_ys
from hera_om.aircraft.schema import schema_markdown as schema_markdown
