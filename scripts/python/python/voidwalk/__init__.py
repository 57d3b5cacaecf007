"""Will this filter hold this soil? Packings, constrictions, void networks and walking base particles.

The calls are those of the program voidwalk and give the same bits. Lengths are in mm unless a name says otherwise.

Where to begin; ``help(voidwalk.judge)`` and the like have arguments and an example each:

=======================================  =====================================================================
call                                     answer
=======================================  =====================================================================
``judge(base, filter)``                  does this filter hold this base? A :class:`Result`
``rules(base, filter)``                  what the rules of practice say, without a walk
``specification(base)``                  a filter for this base by practice: a :class:`Specification`
``boundary(base, filter)``               where the model begins to erode a base: :class:`Boundaries`
``soil(soil)``                           what is understood of a sieve table
``Network(...)``, ``walk(...)``          a network of your own, and base particles through it
``run(scene)``, ``campaign(plan)``       every setting, in a scene or a plan
``read(folder)``                         results that lie in a folder
=======================================  =====================================================================

A soil is the file of a sieve table (CSV with opening in mm and percent finer by mass, .xlsx, .ods or AGS4), a pair of
arrays (sizes in mm, percents finer), or a :class:`Gradation`. The base comes first, then the filter. ``voidwalk.records``
says what each dict holds, ``voidwalk.columns`` what each table.

Examples
--------
Two sieve curves; ``quick`` and small networks save time here:

>>> import voidwalk as vw
>>> base, filter = ([0.08, 0.3], [0, 100]), ([0.5, 2.0], [0, 100])
>>> small = {"network.nx": 10, "network.ny": 10, "network.nz": 12}
>>> result = vw.judge(base, filter, density="dense", quick=True, settings=small)
>>> result.headline, result.model["class"]
('does not meet practice', 'no erosion')

A network:

>>> import voidwalk as vw
>>> network = vw.Network.cubic([10, 10, 20], "cu1.5-loose")
>>> base = vw.Gradation.linear(1.5, 0.2, percent=85)
>>> vw.walk(network, base, n_base=20_000, replicates=3).verdict
'continuing erosion'
"""

from ._grains import Constrictions, Packing, constrictions, pack
from ._judge import judge, rules, soil
from ._network import Network
from ._read import read
from ._result import CampaignResult, Result, WalkResult
from ._scene import Scene, init_text, scene_text, schema
from ._soil import Curve, Gradation
from ._specification import Specification, specification
from ._studies import Boundaries, boundary, percolation, study
from ._voidwalk import Progress, VoidwalkError, __version__
from ._walk import campaign, replicate_seed, resume, run, walk

__all__ = [
    "CampaignResult", "Constrictions", "Curve", "Boundaries", "Gradation", "Network", "Packing", "Progress", "Result",
    "Scene", "Specification", "VoidwalkError", "WalkResult", "__version__", "campaign", "constrictions", "boundary",
    "init_text", "judge", "pack", "percolation", "read", "replicate_seed", "resume", "rules", "run", "scene_text",
    "schema", "soil", "specification", "study", "walk",
]
