"""Flexible bodies: from the cache, or reduced from the files of a finite-element program."""

from ..errors import Fault, ModelError
from ..model.diagnostics import Findings
from ..model.flexible_body import FlexibleBody, FlexibleInput
from . import cache


def flexible_body(given: FlexibleInput, cached: bool = True) -> tuple[FlexibleBody, list[Fault]]:
    """The body that `given` describes, and what was doubtful about its files.

    Raises ModelError with every fault found, at the cards of the files.
    """
    found = cache.load(given) if cached else None
    if found is not None:
        return found
    # Most runs find their bodies in the cache and do without.
    from .reduction import reduced_body

    findings = Findings()
    body = reduced_body(given, findings)
    if body is None or any(fault.severity == "error" for fault in findings.faults):
        raise ModelError(findings.in_order)
    if cached:
        cache.store(given, body, findings.faults)
    return body, findings.in_order
