"""Many problems on many processes or machines: a row for every problem, whatever happens.

``run`` works on this machine, one ``shard`` of a batch at a time: a job of Slurm or Kubernetes runs one shard. ``foliate.cluster.ray.run`` does the same by tasks of Ray. Both write the same
rows into a folder, part by part, and skip what an earlier run has finished.
"""

from foliate.cluster.local import run
from foliate.cluster.parts import rows
from foliate.cluster.problem import Problem

__all__ = ["Problem", "rows", "run"]
