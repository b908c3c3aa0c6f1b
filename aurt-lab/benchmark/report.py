"""The table: one row per case, one column per tool."""

from dataclasses import dataclass
from types import ModuleType

from cases import ArmCase, DriveCase, Truth
from result import processor_s
from rollouts import motion, rollout_error
from signals import held_out_error


@dataclass(frozen=True)
class Score:
    """What a tool says of a case: errors of its estimates, held-out error, processor time."""

    estimates: str
    held_out: float | None
    seconds: float


def score(case: ArmCase | DriveCase, tool: ModuleType) -> Score:
    """Runs a tool on a case."""
    begin = processor_s()
    result = tool.solve(case)
    seconds = processor_s() - begin
    held_out = None
    if result.predictions is not None:
        held_out = (held_out_error if isinstance(case, ArmCase) else rollout_error)(case, result.predictions)
    errors = [error(truth, result.values.get(name)) for name, truth in case.truth.items()]
    known = errors if any(name in result.values for name in case.truth) else ["–"] * bool(errors)
    return Score(", ".join(known), held_out, seconds)


def error(truth: Truth, value: float | None) -> str:
    """An estimate against the truth: per cent, or the difference where the truth is zero."""
    if value is None:
        return "–"
    text = f"{value:+.3f}" if truth.value == 0.0 else f"{100 * (value / truth.value - 1):+.1f}"
    return text.replace("-", "−") + (f" {truth.unit}" if truth.value == 0.0 else " %")


def truths(case: ArmCase | DriveCase) -> str:
    """What is known, in the order of the errors; of rollouts, the error of the command itself."""
    if isinstance(case, DriveCase):
        commands = [motion(case, part).command for part in case.held_out]
        return f"command itself {rollout_error(case, commands):.1f} mrad"
    return ", ".join(f"{truth.value:g} {truth.unit}".replace("-", "−") for truth in case.truth.values()) or "–"


def cell(found: Score | None, best: float | None, unit: str) -> str:
    """Estimates; held-out error; time."""
    if found is None:
        return "–"
    held_out = "–"
    if found.held_out is not None:
        held_out = f"{found.held_out:.2f} {unit}" if found.held_out < 10 else f"{found.held_out:.1f} {unit}"
        if found.held_out == best:
            held_out = f"**{held_out}**"
    return "; ".join(part for part in (found.estimates, held_out, f"{found.seconds:.1f} s") if part)


def table(scores: dict[str, dict[str, Score]], cases: dict[str, ArmCase | DriveCase], tools: list[str]) -> str:
    """The table in Markdown; the least held-out error of a row is bold."""
    lines = [f"| case | truth | {' | '.join(tools)} |", "|---" * (len(tools) + 2) + "|"]
    for name, found in scores.items():
        case = cases[name]
        unit = "%" if isinstance(case, ArmCase) else "mrad"
        best = min((s.held_out for s in found.values() if s.held_out is not None), default=None)
        row = " | ".join(cell(found.get(tool), best, unit) for tool in tools)
        lines.append(f"| {case.title} | {truths(case)} | {row} |")
    return "\n".join(lines)
