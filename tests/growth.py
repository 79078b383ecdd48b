"""How the time of a task grows with its size: a ratio holds on a loaded machine, where seconds do not."""

import time
from collections.abc import Callable


def growth(task: Callable[[int], object], size: int) -> float:
    """How many times as long `task(4 * size)` takes as `task(size)`: 4 for linear time, 16 for quadratic.

    Both are the least of three runs, the sizes in turn.
    """
    least = {size: float("inf"), 4 * size: float("inf")}
    for _ in range(3):
        for count in least:
            begun = time.process_time()
            task(count)
            least[count] = min(least[count], time.process_time() - begun)
    return least[4 * size] / least[size]


# Between linear and quadratic time.
LINEAR = 9.0
