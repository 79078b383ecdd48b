"""Text of `flexmb verify` about two formulations of one deck."""

from typing import Any

from ...errors import visible


def verify_text(found: Any) -> str:
    """A line for each quantity of a `run.verify.verify.Verification`, then the largest difference."""
    outcome = found.outcome
    lines = [f"{visible(outcome.deck)}: {found.formulations}, {outcome.rows} rows"]
    lines.append(f"  {'quantity':<26}{'difference':>12}{'of':>12} {'unit':<6}{'share':>10}{'at':>12}")
    for each in found.differences:
        lines.append(
            f"  {each.name:<26}{each.difference:>12.2e}{each.scale:>12.4g} {each.unit:<6}"
            f"{each.relative:>10.1e}{each.time:>10.4g} s"
        )
    worst = found.largest
    relation = "within" if worst.relative <= found.tolerance else "beyond"
    lines.append(
        f"  largest: {worst.name}, {worst.relative:.1e} of the largest value, {relation} {found.tolerance:g}"
    )
    return "\n".join(lines) + "\n"
