//! The recursive Newton–Euler algorithm, written out for one chain or tree and its parameters.

use aurt_rbd::{INERTIAL_PARAMETERS, Joint, JointKind, Parent, RbdError, SerialChain};

use super::tape::{Function, Tape, Value, ZERO};

pub(crate) type Vector = [Value; 3];

/// A joint's constants and the sine and cosine of its angle.
#[derive(Debug, Clone)]
struct Place {
    kind: JointKind,
    sign: f64,
    /// The link that it sits on, none of the base.
    parent: Option<usize>,
    /// Maps coordinates in the joint's frame to the parent link's frame.
    rotation: [[f64; 3]; 3],
    origin: Vector,
    sine: Value,
    cosine: Value,
}

/// A chain at joint coordinates q, of which dynamics are written.
#[derive(Debug, Clone)]
pub(crate) struct Posture {
    places: Vec<Place>,
}

impl Posture {
    /// Writes what depends on the joint coordinates alone.
    ///
    /// # Errors
    /// None for a chain that exists: its joints are joined anew, one by one.
    pub fn new(tape: &mut Tape, chain: &SerialChain, q: &[Value]) -> Result<Self, RbdError> {
        let places = chain
            .joints()
            .iter()
            .zip(q)
            .enumerate()
            .map(|(j, (joint, q))| Place::new(tape, joint, chain.parent(j), *q))
            .collect::<Result<_, _>>()?;
        Ok(Self { places })
    }

    /// Torques τ of accelerations and velocities under gravity, of bodies with 10 N standard parameters (Luh, Walker,
    /// Paul, 1980; the equations are those of `ChainDynamics::inverse_dynamics`).
    pub fn torque(
        &self,
        tape: &mut Tape,
        standard: &[Value],
        gravity_m_s2: Vector,
        qd: &[Value],
        qdd: &[Value],
    ) -> Vec<Value> {
        let base = [[ZERO; 3], [ZERO; 3], gravity_m_s2.map(|g| tape.negate(g))];
        let mut motions: Vec<[Vector; 3]> = Vec::new();
        let mut loads: Vec<(Vector, Vector)> = Vec::new();
        let bodies = standard.chunks_exact(INERTIAL_PARAMETERS);
        for (((place, body), qd), qdd) in self.places.iter().zip(bodies).zip(qd).zip(qdd) {
            let sign = Value::Constant(place.sign);
            let [mut omega, mut omega_dot, mut accel] = place.parent.map_or(base, |parent| motions[parent]);
            let (rate, rate_dot) = (tape.multiply(sign, *qd), tape.multiply(sign, *qdd));
            let euler = cross(tape, omega_dot, place.origin);
            let inner = cross(tape, omega, place.origin);
            let centrifugal = cross(tape, omega, inner);
            let carried = sum(tape, euler, centrifugal);
            let total = sum(tape, accel, carried);
            accel = place.in_link(tape, total);
            omega = place.in_link(tape, omega);
            omega_dot = place.in_link(tape, omega_dot);
            match place.kind {
                JointKind::Revolute => {
                    let coriolis = cross(tape, omega, [ZERO, ZERO, rate]);
                    let turned = sum(tape, coriolis, [ZERO, ZERO, rate_dot]);
                    omega_dot = sum(tape, omega_dot, turned);
                    omega[2] = tape.add(omega[2], rate);
                }
                JointKind::Prismatic => {
                    let twice = tape.multiply(Value::Constant(2.0), rate);
                    let coriolis = cross(tape, omega, [ZERO, ZERO, twice]);
                    let slid = sum(tape, coriolis, [ZERO, ZERO, rate_dot]);
                    accel = sum(tape, accel, slid);
                }
            }
            motions.push([omega, omega_dot, accel]);
            loads.push(wrench(tape, body, omega, omega_dot, accel));
        }
        self.inward(tape, &mut loads)
    }

    /// Adds moments and forces from the last link to the first, each to those of its parent; a joint carries what acts about or along its axis.
    fn inward(&self, tape: &mut Tape, loads: &mut [(Vector, Vector)]) -> Vec<Value> {
        let mut torques = vec![ZERO; self.places.len()];
        for (i, place) in self.places.iter().enumerate().rev() {
            let (moment, force) = loads[i];
            let carried = match place.kind {
                JointKind::Revolute => moment[2],
                JointKind::Prismatic => force[2],
            };
            torques[i] = tape.multiply(Value::Constant(place.sign), carried);
            if let Some(parent) = place.parent {
                let force = place.in_parent(tape, force);
                let moment = place.in_parent(tape, moment);
                let lever = cross(tape, place.origin, force);
                let moment = sum(tape, moment, lever);
                loads[parent] = (sum(tape, loads[parent].0, moment), sum(tape, loads[parent].1, force));
            }
        }
        torques
    }
}

impl Place {
    fn new(tape: &mut Tape, joint: &Joint, parent: Option<usize>, q: Value) -> Result<Self, RbdError> {
        let revolute = joint.kind == JointKind::Revolute;
        // The constant part of the placement: that of a chain of this joint alone at coordinate zero.
        let theta_offset_rad = if revolute { 0.0 } else { joint.theta_offset_rad };
        let alone = Joint { parent: Parent::Base, theta_offset_rad, ..*joint };
        let mut frames = Vec::new();
        SerialChain::new(vec![alone], [0.0; 3])?.link_frames(&[0.0], &mut frames);
        let (rotation, translation) =
            frames.first().map_or(([[0.0; 3]; 3], [0.0; 3]), |f| (f.rotation, f.origin_m));
        let mut origin = translation.map(Value::Constant);
        let along = tape.multiply(Value::Constant(joint.sign), q);
        let (mut sine, mut cosine) = (ZERO, Value::Constant(1.0));
        if revolute {
            let angle = tape.add(along, Value::Constant(joint.theta_offset_rad));
            sine = tape.call(Function::Sin, &[angle]);
            cosine = tape.call(Function::Cos, &[angle]);
        } else {
            for (entry, row) in origin.iter_mut().zip(&rotation) {
                let shift = tape.multiply(Value::Constant(row[2]), along);
                *entry = tape.add(*entry, shift);
            }
        }
        Ok(Self { kind: joint.kind, sign: joint.sign, parent, rotation, origin, sine, cosine })
    }

    /// A vector of the parent link's frame in the coordinates of this link.
    fn in_link(&self, tape: &mut Tape, v: Vector) -> Vector {
        let r = &self.rotation;
        let transposed = [0, 1, 2].map(|row| [r[0][row], r[1][row], r[2][row]]);
        let [x, y, z] = by_constants(tape, &transposed, v);
        let (cx, sy) = (tape.multiply(self.cosine, x), tape.multiply(self.sine, y));
        let (cy, sx) = (tape.multiply(self.cosine, y), tape.multiply(self.sine, x));
        [tape.add(cx, sy), tape.subtract(cy, sx), z]
    }

    /// A vector of this link in the coordinates of the parent link's frame.
    fn in_parent(&self, tape: &mut Tape, [x, y, z]: Vector) -> Vector {
        let (cx, sy) = (tape.multiply(self.cosine, x), tape.multiply(self.sine, y));
        let (cy, sx) = (tape.multiply(self.cosine, y), tape.multiply(self.sine, x));
        let turned = [tape.subtract(cx, sy), tape.add(cy, sx), z];
        by_constants(tape, &self.rotation, turned)
    }
}

/// Moment and force that a body needs, about and at its frame's origin.
fn wrench(
    tape: &mut Tape,
    body: &[Value],
    omega: Vector,
    omega_dot: Vector,
    accel: Vector,
) -> (Vector, Vector) {
    let inertia = [[body[0], body[1], body[2]], [body[1], body[3], body[4]], [body[2], body[4], body[5]]];
    let h = [body[6], body[7], body[8]];
    let by_mass = accel.map(|a| tape.multiply(body[9], a));
    let euler = cross(tape, omega_dot, h);
    let inner = cross(tape, omega, h);
    let centrifugal = cross(tape, omega, inner);
    let turning = sum(tape, euler, centrifugal);
    let force = sum(tape, by_mass, turning);
    let angular = by_values(tape, &inertia, omega_dot);
    let momentum = by_values(tape, &inertia, omega);
    let gyroscopic = cross(tape, omega, momentum);
    let lever = cross(tape, h, accel);
    let turning = sum(tape, angular, gyroscopic);
    (sum(tape, turning, lever), force)
}

fn by_constants(tape: &mut Tape, matrix: &[[f64; 3]; 3], v: Vector) -> Vector {
    by_values(tape, &matrix.map(|row| row.map(Value::Constant)), v)
}

fn by_values(tape: &mut Tape, matrix: &[Vector; 3], v: Vector) -> Vector {
    matrix.map(|row| {
        let products = [0, 1, 2].map(|k| tape.multiply(row[k], v[k]));
        let first = tape.add(products[0], products[1]);
        tape.add(first, products[2])
    })
}

fn sum(tape: &mut Tape, a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|k| tape.add(a[k], b[k]))
}

fn cross(tape: &mut Tape, a: Vector, b: Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, k)| {
        let (plus, minus) = (tape.multiply(a[i], b[k]), tape.multiply(a[k], b[i]));
        tape.subtract(plus, minus)
    })
}
