"""The table: one row per case and tool."""

from dataclasses import dataclass
from types import ModuleType

from cases import ArmCase, DriveCase, Truth
from result import processor_s
from rollouts import rollout_error
from signals import Skipped, held_out_error

HEAD = (
    "| case | tool | estimates: error against the truth | held-out error | processor s |",
    "|---|---|---|---|---|",
)


@dataclass(frozen=True)
class Line:
    """A row of the table."""

    case: str
    tool: str
    estimates: str
    held_out: str
    seconds: float


def line(case: ArmCase | DriveCase, tool: ModuleType) -> Line:
    """Runs a tool on a case and scores it."""
    if not isinstance(case, tool.CASES):
        raise Skipped("not a case of this tool")
    begin = processor_s()
    result = tool.solve(case)
    seconds = processor_s() - begin
    estimates = ", ".join(estimate(name, truth, result.values) for name, truth in case.truth.items())
    held_out = "–"
    if result.predictions is not None:
        score, unit = (held_out_error, "%") if isinstance(case, ArmCase) else (rollout_error, "mrad")
        held_out = f"{score(case, result.predictions):.2f} {unit}"
    return Line(case.title, tool.NAME, estimates or "–", held_out, seconds)


def estimate(name: str, truth: Truth, values: dict[str, float]) -> str:
    """An estimate and its error."""
    if name not in values:
        return f"{name} –"
    value = float(values[name])
    if truth.value == 0.0:
        return f"{name} {value:+.3f} {truth.unit} of 0"
    return f"{name} {100 * (value / truth.value - 1):+.1f} %"


def table(lines: list[Line]) -> str:
    """The table in Markdown."""
    rows = (f"| {r.case} | {r.tool} | {r.estimates} | {r.held_out} | {r.seconds:.1f} |" for r in lines)
    return "\n".join((*HEAD, *rows))
