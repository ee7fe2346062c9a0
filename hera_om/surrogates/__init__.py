"""Surrogates of a discipline: sampling plans, Kriging and RBF models, their quality, and their files.

Trained with SMT, predicted in JAX; what a discipline computes is of no concern here.
"""

from hera_om.core import precision
from hera_om.surrogates.domain import Outside as Outside
from hera_om.surrogates.quality import Quality as Quality
from hera_om.surrogates.samples import Samples as Samples
from hera_om.surrogates.sampling import latin_hypercube as latin_hypercube
from hera_om.surrogates.sampling import sobol as sobol
from hera_om.surrogates.store import load as load
from hera_om.surrogates.store import save as save
from hera_om.surrogates.surrogate_set import Predictor as Predictor
from hera_om.surrogates.surrogate_set import SurrogateSet as SurrogateSet
from hera_om.surrogates.surrogate_set import outside as outside
from hera_om.surrogates.surrogate_set import predict as predict
from hera_om.surrogates.training import train as train

precision.enable()
