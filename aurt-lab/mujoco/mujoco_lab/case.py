"""One case: an arm, its motions, an effect of a wanted strength, the recordings and the truth."""

import copy
import json
from dataclasses import dataclass

import numpy as np

from . import arm, motions, robots, sensing
from .effect import Effect
from .requests import KINDS, STRENGTHS, VOCABULARY
from .structure import F_DYN_HZ, NoiseFree, Processed, Structure

# Ratio to the wanted strength within which it is met.
MET = 1.25
PROBES, ATTEMPTS, REDRAWS = 4, 5, 4
# Seconds of a recording that a first guess of the size looks at.
PROBE_S = 10.0
# Share of the strongest joint's error from which a joint counts as one whose error a whole-arm effect makes, and the
# least such error over noise.
CONCERNED, LEAST = 0.2, 0.1


@dataclass
class Slot:
    role: str
    motion: object
    affected: bool


@dataclass
class Bench:
    """The arm as the experiment knows it, its motions, and what they look like without any effect."""

    robot: object
    servo: tuple
    slots: list
    structure: object
    calm: list


def make(request, settings, seed, index):
    """Files of the case's folder by name, and the sealed truth. Raises arm.Divergence if no draw can be simulated."""
    for draw in range(REDRAWS):
        try:
            return _make(request, settings, [seed, index, draw])
        except arm.Divergence:
            if draw == REDRAWS - 1:
                raise
    raise AssertionError("unreachable")


def _slots(robot, later, duration_s, known, random):
    sort = (motions.waves, motions.slow, motions.poses)
    if later:
        order = [("calibration", 0), ("calibration", 1), ("target", 0), ("target", 1), ("validation", 0)]
    else:
        order = [("calibration", 0), ("calibration", 0), ("calibration", 1), ("validation", 0), ("validation", 2)]
    slots = []
    for role, kind in order:
        motion = sort[kind](robot, duration_s, random)
        motions.feed_forward(robot, motion, known)
        slots.append(Slot(role, motion, not later or role != "calibration"))
    return slots


def _make(request, settings, seed):
    random = np.random.default_rng(seed)
    kinds = [KINDS[name] for name in request.effects]
    geared = next((k.geared for k in kinds if k.geared is not None), bool(random.uniform() < 0.5))
    presence = next((k.presence for k in kinds if k.presence != "either"), None)
    later = presence == "later" if presence else bool(random.uniform() < 0.5)
    robot = robots.draw(request.robot, random, geared)
    servo, known = motions.servo(robot, random)
    duration_s = settings["duration_s"]
    slots = _slots(robot, later, duration_s, known, random)
    plain = _bench(robot, servo, slots, [])
    best = None
    wanted = STRENGTHS[request.strength]
    for _ in range(ATTEMPTS if kinds else 1):
        effects = _drawn(kinds, plain, duration_s, random)
        hidden = [(j, e.hides) for e in effects if e.hides for j in e.joints]
        try:
            bench = _bench(_without(robot, hidden), servo, slots, hidden) if hidden else plain
            for effect in effects:
                effect.robot = bench.robot
            found = [_to_strength(bench, effect, wanted) for effect in effects]
        except arm.Divergence:
            continue
        off = max((abs(np.log(s / wanted)) for e, a in zip(effects, found) for s in _own(e, a)), default=0.0)
        if best is None or off < best[0]:
            best = off, bench, effects, found
        if off <= np.log(MET):
            break
    if best is None:
        raise arm.Divergence(f"{request.name}: no draw of {' and '.join(request.effects)} could be simulated")
    _, bench, effects, found = best
    return _written(request, settings, seed, bench, effects, found, later, random)


def _without(robot, hidden):
    robot = copy.copy(robot)
    robot.coulomb_nm, robot.viscous_nm_s = robot.coulomb_nm.copy(), robot.viscous_nm_s.copy()
    for joint, term in hidden:
        (robot.coulomb_nm if term == "coulomb" else robot.viscous_nm_s)[joint] = 0.0
    return robot


def _bench(robot, servo, slots, hidden):
    calm = [arm.run(arm.Build.of(robot), servo, slot.motion) for slot in slots]
    return Bench(robot, servo, slots, Structure.of(robot, hidden), calm)


def _drawn(kinds, bench, duration_s, random):
    """Effects on joints that do not overlap."""
    robot, effects, taken = bench.robot, [], set()
    for kind in kinds:
        fit = [j for j in random.permutation(robot.joints) if j not in taken and kind.suits(robot, int(j))]
        if not fit:
            raise arm.Divergence(f"{robot.name} has no joint for {kind.identifier}")
        count = {"all": robot.joints, "pair": 2, "one": 1, "few": 1 + int(random.uniform() < 0.3)}[kind.takes]
        joints = list(range(robot.joints)) if kind.takes == "all" else [int(j) for j in fit[:count]]
        if kind.takes == "few":
            joints.sort()
        effect = kind(robot, joints, random, duration_s)
        if kind.identifier == "saturation":
            effect.peak_nm = np.max([np.abs(trace.torque_nm).max(0) for trace in bench.calm], 0)
        if not kind.whole_arm:
            taken |= set(effect.joints)
        effects.append(effect)
    return effects


def _build(bench, effects):
    build, instrument = arm.Build.of(bench.robot), sensing.Instrument.of(bench.robot)
    for effect in effects:
        effect.install(build)
        effect.sense(instrument)
    return build, instrument


def _changes_arm(effect):
    return type(effect).install is not Effect.install


def _own(effect, achieved):
    """Strengths that the effect is to have: on each joint of its own, or on the strongest."""
    if effect.takes == "few":
        return [max(achieved[j], 1e-6) for j in effect.joints]
    return [max(max(achieved if effect.whole_arm else achieved[effect.joints]), 1e-6)]


def _shown(bench, effect):
    """Slots whose torque shows the effect."""
    role = "target" if any(s.role == "target" for s in bench.slots) else "calibration"
    slots = [k for k, slot in enumerate(bench.slots) if slot.role == role]
    return slots[:1] if effect.window_s else slots


def _clipped(trace, samples):
    return arm.Trace(*(series[:samples] for series in
                       (trace.time_s, trace.q_rad, trace.v_rad_s, trace.a_rad_s2, trace.torque_nm)))


def _strength(bench, effect, seconds):
    """Torque that the structure cannot absorb over noise, per joint, in the recording that shows most of it."""
    build, instrument = _build(bench, [effect])
    calm = sensing.Instrument.of(bench.robot)
    slots = _shown(bench, effect)
    pairs = []
    for k in slots:
        motion, undisturbed = bench.slots[k].motion, bench.calm[k]
        if seconds < motion.duration_s:
            undisturbed = _clipped(undisturbed, int(seconds / arm.STEP_S))
            motion = copy.copy(motion)
            motion.duration_s = seconds
        disturbed = arm.run(build, bench.servo, motion) if _changes_arm(effect) else undisturbed
        pairs.append((NoiseFree(bench.structure, disturbed, instrument, effect.window_s),
                      NoiseFree(bench.structure, undisturbed, calm, effect.window_s)))
    if bench.slots[slots[0]].role == "target":
        reference = [NoiseFree(bench.structure, bench.calm[k], calm).parts()
                     for k, slot in enumerate(bench.slots) if slot.role == "calibration"]
        fit = plain = bench.structure.fit(reference)
    else:
        # What is there at calibration, calibration adapts to as far as it can.
        fit = bench.structure.fit([with_it.parts() for with_it, _ in pairs])
        plain = bench.structure.fit([without.parts() for _, without in pairs])
    gains = [with_it.left_over(fit) - without.left_over(plain) for with_it, without in pairs]
    return np.sqrt(np.maximum(np.max(gains, 0), 0))


def _to_strength(bench, effect, wanted):
    """Corrects the size until the strength is met; strengths per joint."""
    if effect.identifier == "dropped_samples":
        # Rows are lost, no torque is added: the size is the share of rows.
        effect.scale(wanted)
        return np.full(bench.robot.joints, wanted)
    duration_s = bench.slots[0].motion.duration_s
    whole = effect.window_s is not None or effect.slow or not _changes_arm(effect)
    power, last = np.ones(len(effect.size)), None
    for probe in range(PROBES + 2):
        seconds = duration_s if whole or probe >= PROBES - 1 else min(PROBE_S, duration_s)
        achieved = _strength(bench, effect, seconds)
        own = np.log(np.array(_own(effect, achieved)) / wanted)
        met = np.abs(own).max() <= np.log(MET if seconds == duration_s else 1.1)
        stuck = last is not None and np.all(np.abs(own - last[0]) < 0.01)
        if met and seconds == duration_s or stuck or probe == PROBES + 1:
            return achieved if seconds == duration_s else _strength(bench, effect, duration_s)
        if met:
            whole = True
            continue
        if last is not None:
            run, rise = last[1], own - last[0]
            power = np.where(np.abs(run) > 1e-3, np.clip(rise / np.where(run == 0, 1, run), 0.35, 3.0), power)
        step = np.clip(-own / power, -2.5, 2.5)
        before = effect.size.copy()
        effect.scale(np.exp(step))
        last = own, np.log(effect.size / before)
    raise AssertionError("unreachable")


def _written(request, settings, seed, bench, effects, found, later, random):
    robot, structure = bench.robot, bench.structure
    calm_sensors = sensing.Instrument.of(robot)
    first_target = next((k for k, slot in enumerate(bench.slots) if slot.role == "target"), None)
    files, processed, calm_processed = {}, [], []
    for k, slot in enumerate(bench.slots):
        here = [e for e in effects if slot.affected and (e.window_s is None or k == first_target)]
        build, instrument = _build(bench, here)
        trace = arm.run(build, bench.servo, slot.motion) if any(map(_changes_arm, here)) else bench.calm[k]
        noise = int(random.integers(2 ** 62))
        rows = sensing.log(robot, instrument, trace, settings, np.random.default_rng(noise))
        files[f"recording_{k + 1}.csv"] = sensing.csv(robot, *rows)
        processed.append(Processed(structure, *rows))
        if here:
            rows = sensing.log(robot, calm_sensors, bench.calm[k], settings, np.random.default_rng(noise))
            calm_processed.append(Processed(structure, *rows))
        else:
            calm_processed.append(processed[-1])
    files["experiment.toml"] = _experiment(robot, structure, bench.slots)
    files["mdh.csv"] = "alpha,a,d\n" + "".join(f"{r[0]!r},{r[1]!r},{r[2]!r}\n" for r in robot.mdh.tolist())
    truth = {
        "case": request.name, "world": "mujoco", "seed": int(np.random.default_rng(seed).integers(2 ** 62)),
        "robot": request.robot, "rotors": "geared" if robot.geared else "in_links",
        "case_type": request.case_type, "strength": request.strength,
        "effects": [_true_effect(e, a, bench, later, first_target) for e, a in zip(effects, found)],
        "noise_nm": robot.torque_noise_nm.tolist(),
        "validation": _floors(structure, bench.slots, processed, calm_processed),
    }
    return files, json.dumps(truth, indent=2) + "\n"


def _true_effect(effect, achieved, bench, later, first_target):
    joints = sorted(effect.joints)
    if effect.whole_arm:
        least = max(CONCERNED * achieved.max(), LEAST)
        joints = [j for j in range(bench.robot.joints) if achieved[j] >= least]
    window = effect.window_s
    return {
        "effect": effect.identifier, "family": effect.family, "in_vocabulary": effect.identifier in VOCABULARY,
        "joints": joints, "present_in": ["target" if later else "calibration"],
        "recording": f"recording_{first_target + 1}.csv" if window else None, "window_s": window,
        "parameters": effect.parameters(), "achieved": achieved.tolist(), "fields": effect.fields(),
    }


def _floors(structure, slots, processed, calm):
    calibration = [k for k, slot in enumerate(slots) if slot.role == "calibration"]
    fits = [structure.fit([data[k].rows() for k in calibration]) for data in (processed, calm)]
    return [{"recording": f"recording_{k + 1}.csv", "before_nm": processed[k].residual_rms_nm(fits[0]).tolist(),
             "floor_nm": calm[k].residual_rms_nm(fits[1]).tolist()}
            for k, slot in enumerate(slots) if slot.role == "validation"]


def _experiment(robot, structure, slots):
    """The experiment file: what whoever diagnoses the case is told."""
    def numbers(values):
        return "[" + ", ".join(repr(float(v)) for v in values) + "]"

    lines = ["schema = 1", "", "[robot]", 'mdh = "mdh.csv"', f"gravity_m_s2 = {numbers(robot.gravity_m_s2)}"]
    if robot.ampere:
        lines.append(f"torque_constants_nm_per_a = {numbers(robot.torque_constant_nm_per_a)}")
    lines += ["", "[joint_dynamics]", 'coulomb = { model = "constant" }', 'hysteresis = { model = "sign" }',
              'viscous = { model = "polynomial", powers = [1] }']
    for j in range(robot.joints):
        if not (structure.coulomb[j] and structure.viscous[j]):
            lines += ["", "[[joint_dynamics.override]]", f"joints = [{j}]"]
            if not structure.coulomb[j]:
                lines.append('coulomb = { model = "absent" }')
            if not structure.viscous[j]:
                lines.append('viscous = { model = "polynomial", powers = [] }')
    if structure.rotors:
        lines += ["", "[[arm_terms]]", 'model = "rotor_inertia"', f"joints = {structure.rotors}"]
    lines += ["", "[recordings]"]
    for role in ("calibration", "target", "validation"):
        names = [f'"recording_{k + 1}.csv"' for k, slot in enumerate(slots) if slot.role == role]
        if names:
            lines.append(f"{role} = [{', '.join(names)}]")
    return "\n".join([*lines, "", "[preprocess]", f"f_dyn_hz = {F_DYN_HZ}"]) + "\n"
