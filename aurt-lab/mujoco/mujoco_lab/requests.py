"""Which cases a plan asks for, as far as this world has them."""

from dataclasses import asdict, dataclass

import numpy as np

from . import friction, mechanics, robots, sensing, unknown_effects

VOCABULARY = {kind.identifier: kind for kind in friction.EFFECTS + mechanics.EFFECTS + sensing.EFFECTS}
UNKNOWN_EFFECTS = {kind.identifier: kind for kind in unknown_effects.EFFECTS}
KINDS = VOCABULARY | UNKNOWN_EFFECTS
STRENGTHS = {"weak": 0.3, "medium": 1.0, "strong": 3.0}
# Effects that act between the engine's steps, which take a rigid arm.
BETWEEN_STEPS = {"coulomb_asymmetry", "viscous_asymmetry", "viscous_nonlinear", "stribeck", "presliding_hysteresis",
                 "load_dependent_friction", "drive_efficiency", "temperature_dependent_friction", "torque_ripple"}
COMPLIANT = {"joint_elasticity", "backlash"}


class Unknown(Exception):
    """A plan asks for what this world does not have."""


@dataclass
class Request:
    """One case to be made."""

    name: str
    case_type: str
    effects: list
    strength: str
    robot: str

    def json(self):
        return asdict(self)


def possible(effects):
    """Whether effects can be together: same rotors, same presence, and a rigid arm where a law needs one."""
    kinds = [KINDS[name] for name in effects]
    rotors = {kind.geared for kind in kinds} - {None}
    presence = {kind.presence for kind in kinds} - {"either"}
    names = set(effects)
    return len(rotors) < 2 and len(presence) < 2 and not (names & COMPLIANT and names & BETWEEN_STEPS) \
        and not (names >= COMPLIANT)


def _robots(names):
    for name in names or []:
        if name not in robots.NAMES:
            raise Unknown(f"the plan's robot `{name}` is not in this world; known: {', '.join(robots.NAMES)}")
    return list(names) if names else list(robots.NAMES)


def _strength(name):
    if name not in STRENGTHS:
        raise Unknown(f"the plan's strength `{name}` is not known; known: {', '.join(STRENGTHS)}")
    return name


def _chosen(names, known):
    """Effects of a plan that this world has; all of them if it names none."""
    return [name for name in names if name in known] if names else list(known)


def _foreign(names):
    """Unknown effects of this world: those named, and for each name of another world's unknown effect one of ours in turn."""
    if not names:
        return list(UNKNOWN_EFFECTS)
    chosen = [name for name in names if name in UNKNOWN_EFFECTS]
    ours = [name for name in UNKNOWN_EFFECTS if name not in chosen]
    return chosen + ours[: len(names) - len(chosen)]


def requests(plan, seed):
    """All cases in an order that tells nothing; the same for the same plan and seed. Raises Unknown."""
    random = np.random.default_rng([seed, 0x9E37])
    found = []
    for part, case_type, choose in (
            ("singles", "single", lambda names: _chosen(names, VOCABULARY)), ("unknown_effects", "unknown_effect", _foreign)):
        asked = plan.get(part) or None
        if asked is None:
            continue
        arms, turn = _robots(asked.get("robots")), 0
        for effect in choose(asked.get("effects") or []):
            for strength in asked.get("strengths") or list(STRENGTHS):
                for _ in range(int(asked.get("trials", 1))):
                    found.append((case_type, [effect], _strength(strength), arms[turn % len(arms)]))
                    turn += 1
    pairs = plan.get("pairs") or {}
    names = _chosen(pairs.get("effects") or [], VOCABULARY)
    for k in range(int(pairs.get("count", 0))):
        arms = _robots(pairs.get("robots"))
        both = [[a, b] for a in names for b in names if a < b and possible([a, b])]
        if not both:
            raise Unknown("no two of the plan's effects can be on one arm at once in this world")
        found.append(("pair", both[random.integers(len(both))], _strength(pairs.get("strength", "medium")),
                      arms[k % len(arms)]))
    nulls = plan.get("nulls") or {}
    arms = _robots(nulls.get("robots"))
    found += [("null", [], "medium", arms[k % len(arms)]) for k in range(int(nulls.get("count", 0)))]
    order = random.permutation(len(found))
    return [Request(f"case_{place + 1:04}", *found[k]) for place, k in enumerate(order)]
