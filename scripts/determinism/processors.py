"""Run every shipped deck as if on other processors, and tell which printed tables do not depend on them.

Example: scripts/determinism/run processors
OpenBLAS takes other kernels (OPENBLAS_CORETYPE), numpy leaves its vector instructions alone
(NPY_DISABLE_CPU_FEATURES).  Flexible bodies are reduced anew each time.
"""

import argparse
import tempfile
from collections import defaultdict
from pathlib import Path

from rounds import differences
from shipped import KINDS, flexmb, shipped, written

PROCESSORS = {
    "this one": {},
    "OpenBLAS for Prescott": {"OPENBLAS_CORETYPE": "Prescott"},
    "OpenBLAS for Haswell": {"OPENBLAS_CORETYPE": "Haswell"},
    "OpenBLAS for Zen": {"OPENBLAS_CORETYPE": "Zen"},
    "numpy without AVX": {"NPY_DISABLE_CPU_FEATURES": "AVX2 FMA3 AVX512F AVX512CD AVX512_SKX"},
}


def results_on(environment: dict[str, str], kinds) -> dict:
    """Files that a processor gives, by name."""
    with tempfile.TemporaryDirectory(prefix="flexmb-cpu-") as name:
        scratch = Path(name)
        for kind in kinds:
            given = {**environment, "FLEXMB_CACHE_DIR": str(scratch / "bodies")}
            folder = scratch / "results" / kind
            flexmb("run", "-q", "-o", folder, *shipped(kind), cwd=scratch, environment=given)
        return written(scratch / "results")


def main():
    """Print what changes from processor to processor, and the decks whose tables do."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=list(KINDS))
    asked = parser.parse_args()
    first, moved = {}, defaultdict(set)
    for processor, environment in PROCESSORS.items():
        found = results_on(environment, asked.kinds)
        first = first or found
        names = differences(first, found)
        print(f"{processor}: {len(found)} files, different: {' '.join(names) or 'none'}", flush=True)
        for name in names:
            moved["results" if name.endswith(".h5") else "tables"].add(name)
    files = {"results": sum(name.endswith(".h5") for name in first)}
    files["tables"] = len(first) - files["results"]
    for what, count in files.items():
        print(f"{what}: {count - len(moved[what])} of {count} do not depend on the processor")


if __name__ == "__main__":
    main()
