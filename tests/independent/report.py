"""What a check found."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field


@dataclass
class Violation:
    """One broken promise. `t` is the segment's parameter in knots (2.25: a quarter of the way from knot 2 to knot
    3), `value` is the amount in SI units, `limit` what would have been allowed. Equal findings (same segment, kind
    and subject) are counted; `t` is the first, `value` the worst."""

    segment: int | None
    t: float | None
    kind: str
    subject: str
    value: float | None
    limit: float | None
    count: int = 1

    def __str__(self) -> str:
        place = "file" if self.segment is None else f"segment {self.segment}"
        place += "" if self.t is None else f" t={self.t:.6g}"
        value = "" if self.value is None else f": {self.value:.6g}"
        limit = "" if self.limit is None else f" (allowed {self.limit:.6g})"
        times = "" if self.count == 1 else f", {self.count} times"
        return f"{place}: {self.kind}: {self.subject}{value}{limit}{times}"


@dataclass
class Report:
    """Violations, remarks and measurements of one check."""

    violations: list[Violation] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=dict)
    min_distance: dict | None = None
    max_residual: dict | None = None
    _index: dict = field(default_factory=dict)

    def violate(self, segment, t, kind: str, subject: str, value=None, limit=None) -> None:
        key = (segment, kind, subject)
        value = None if value is None else float(value)
        t = None if t is None else float(t)
        known = self._index.get(key)
        if known is None:
            known = Violation(segment, t, kind, subject, value, None if limit is None else float(limit))
            self._index[key] = known
            self.violations.append(known)
            return
        known.count += 1
        known.t = t if known.t is None else min(known.t, t)
        if value is not None and known.value is not None and _worse(value, known.value, known.limit):
            known.value = value

    def has(self, kind: str) -> bool:
        return any(violation.kind == kind for violation in self.violations)

    def note(self, text: str) -> None:
        if text not in self.notes:
            self.notes.append(text)

    def count(self, what: str, amount: int = 1) -> None:
        self.counts[what] = self.counts.get(what, 0) + amount

    def see_distance(self, segment: int, t: float, pair: str, distance: float) -> None:
        if self.min_distance is None or distance < self.min_distance["value"]:
            self.min_distance = {"value": float(distance), "segment": segment, "t": float(t), "pair": pair}

    def see_residual(self, segment: int, t: float, subject: str, residual: float) -> None:
        if self.max_residual is None or residual > self.max_residual["value"]:
            self.max_residual = {"value": float(residual), "segment": segment, "t": float(t), "subject": subject}

    def to_json(self) -> dict:
        return {
            "ok": not self.violations,
            "violations": [asdict(violation) for violation in self.violations],
            "notes": self.notes,
            "counts": self.counts,
            "min_distance": self.min_distance,
            "max_residual": self.max_residual,
        }


def _worse(value: float, known: float, limit: float | None) -> bool:
    """Farther on the wrong side of the limit."""
    limit = 0.0 if limit is None else limit
    return abs(value - limit) > abs(known - limit)
