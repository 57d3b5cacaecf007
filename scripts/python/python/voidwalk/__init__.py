"""Will this filter hold this soil? Packings, constrictions, void networks and walking base particles.

The calls are those of the program voidwalk and give the same bits. Lengths are in mm unless a name says otherwise.

Examples
--------
>>> import voidwalk as vw
>>> network = vw.Network.cubic([10, 10, 20], "cu1.5-loose")
>>> base = vw.Gradation.linear(1.5, 0.2, percent=85)
>>> vw.walk(network, base, n_base=20_000, replicates=3).verdict
'continuing erosion'
"""

from ._grains import Constrictions, Packing, constrictions, pack
from ._judge import judge, soil
from ._network import Network
from ._read import read
from ._result import CampaignResult, Result
from ._rules import rules
from ._scene import Scene, init_text, scene_text
from ._schema import schema
from ._soil import Curve, Gradation
from ._specification import Specification, specification
from ._studies import Comparison, Design, compare, design, percolation, study
from ._voidwalk import Progress, VoidwalkError, __version__
from ._walk import campaign, replicate_seed, resume, run, walk

__all__ = [
    "CampaignResult",
    "Comparison",
    "Constrictions",
    "Curve",
    "Design",
    "Gradation",
    "Network",
    "Packing",
    "Progress",
    "Result",
    "Scene",
    "Specification",
    "VoidwalkError",
    "__version__",
    "campaign",
    "compare",
    "constrictions",
    "design",
    "init_text",
    "judge",
    "pack",
    "percolation",
    "read",
    "replicate_seed",
    "resume",
    "rules",
    "run",
    "scene_text",
    "schema",
    "soil",
    "specification",
    "study",
    "walk",
]
