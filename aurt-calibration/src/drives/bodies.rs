//! Rigid bodies in jets: M(q) and C(q, q̇) q̇ + g(q) with their derivatives.
//!
//! All vectors are in the base frame and all moments about its origin, where motions and forces of links add without
//! transformations (Featherstone, *Rigid Body Dynamics Algorithms*, chapters 5 and 6): with the joint's axis
//! S_j = (z_j, o_j × z_j), the torques are S_jᵀ Σ_{i ≥ j} (I_i a_i + v_i ×* I_i v_i) and M_jk = S_jᵀ I_{≥ k} S_k, k ≥ j.

use aurt_rbd::{JointKind, LinkFrame, SerialChain};
use aurt_traits::Jet;

pub(crate) type Vector = [Jet; 3];

/// A motion (angular velocity, velocity of the point at the origin) or a force (moment about the origin, force).
#[derive(Debug, Clone, Copy, Default)]
struct Twist {
    turn: Vector,
    slide: Vector,
}

/// Mass, first moment and inertia {XX XY XZ YY YZ ZZ} about the origin of the base frame.
#[derive(Debug, Clone, Copy, Default)]
struct Inertia {
    mass: Jet,
    moment: Vector,
    inertia: [Jet; 6],
}

fn add(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] + b[i])
}

fn sub(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] - b[i])
}

fn scale(a: Vector, s: Jet) -> Vector {
    a.map(|x| x * s)
}

fn dot(a: Vector, b: Vector) -> Jet {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl Twist {
    fn plus(self, other: Self) -> Self {
        Self { turn: add(self.turn, other.turn), slide: add(self.slide, other.slide) }
    }

    fn times(self, s: Jet) -> Self {
        Self { turn: scale(self.turn, s), slide: scale(self.slide, s) }
    }

    /// The rate of a motion that moves with this one.
    fn carry(self, motion: Self) -> Self {
        Self {
            turn: cross(self.turn, motion.turn),
            slide: add(cross(self.turn, motion.slide), cross(self.slide, motion.turn)),
        }
    }

    /// The rate of a momentum that moves with this motion.
    fn carry_momentum(self, momentum: Self) -> Self {
        Self {
            turn: add(cross(self.turn, momentum.turn), cross(self.slide, momentum.slide)),
            slide: cross(self.turn, momentum.slide),
        }
    }

    fn power(self, force: Self) -> Jet {
        dot(self.turn, force.turn) + dot(self.slide, force.slide)
    }
}

impl Inertia {
    fn momentum(&self, motion: Twist) -> Twist {
        let [xx, xy, xz, yy, yz, zz] = self.inertia;
        let [x, y, z] = motion.turn;
        let spin = [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z];
        Twist {
            turn: add(spin, cross(self.moment, motion.slide)),
            slide: sub(scale(motion.slide, self.mass), cross(self.moment, motion.turn)),
        }
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            moment: add(self.moment, other.moment),
            inertia: std::array::from_fn(|i| self.inertia[i] + other.inertia[i]),
        }
    }
}

#[derive(Debug, Clone, Copy, Default)]
struct Placed {
    axis: Twist,
    rotation: [Vector; 3],
    origin: Vector,
    inertia: Inertia,
}

/// The bodies of an arm, its geometry in numbers.
#[derive(Debug, Clone)]
pub(crate) struct Bodies {
    chain: SerialChain,
    /// Rotation and translation of each joint's frame at the coordinate 0, in the frame of the link before.
    frames: Vec<([[f64; 3]; 3], [f64; 3])>,
    standard: Vec<[f64; 10]>,
    placed: Vec<Placed>,
}

impl Bodies {
    pub(crate) fn new(chain: &SerialChain, standard: &[f64]) -> Self {
        let joints = chain.joints().len();
        // The frames at q = 0, each relative to the one before.
        let mut at_zero = Vec::new();
        chain.link_frames(&vec![0.0; joints], &mut at_zero);
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let relative_to_parent = |(j, frame): (usize, &LinkFrame)| {
            let parent = chain.parent(j).map(|p| at_zero[p]);
            let rotation = parent.map_or(identity, |p| p.rotation);
            let origin = parent.map_or([0.0; 3], |p| p.origin_m);
            let step: [f64; 3] = std::array::from_fn(|i| frame.origin_m[i] - origin[i]);
            let relative = std::array::from_fn(|r| {
                std::array::from_fn(|c| (0..3).map(|k| rotation[k][r] * frame.rotation[k][c]).sum())
            });
            (relative, std::array::from_fn(|r| (0..3).map(|k| rotation[k][r] * step[k]).sum()))
        };
        let frames = at_zero.iter().enumerate().map(relative_to_parent).collect();
        let standard = standard.as_chunks().0.to_vec();
        Self { chain: chain.clone(), frames, standard, placed: vec![Placed::default(); joints] }
    }

    pub(crate) fn joints(&self) -> usize {
        self.frames.len()
    }

    /// Places the links at q, the masses of each link multiplied by `mass_scale`.
    pub(crate) fn place(&mut self, q: &[Jet], mass_scale: &[Jet]) {
        let base: [Vector; 3] =
            std::array::from_fn(|r| std::array::from_fn(|c| Jet::constant(f64::from(u8::from(r == c)))));
        for j in 0..self.joints() {
            let parent = self.chain.parent(j).map(|p| &self.placed[p]);
            let (rotation, mut origin) = parent.map_or((base, [Jet::ZERO; 3]), |p| (p.rotation, p.origin));
            let joint = &self.chain.joints()[j];
            let (relative, translation) = &self.frames[j];
            let along = |v: &[f64; 3]| -> Vector {
                std::array::from_fn(|r| rotation[r][0] * v[0] + rotation[r][1] * v[1] + rotation[r][2] * v[2])
            };
            origin = add(origin, along(translation));
            let columns: [Vector; 3] =
                std::array::from_fn(|c| along(&[relative[0][c], relative[1][c], relative[2][c]]));
            let axis = columns[2].map(|x| x * joint.sign);
            let (x, y) = match joint.kind {
                JointKind::Revolute => {
                    let (sin, cos) = ((q[j] * joint.sign).sin(), (q[j] * joint.sign).cos());
                    (
                        add(scale(columns[0], cos), scale(columns[1], sin)),
                        sub(scale(columns[1], cos), scale(columns[0], sin)),
                    )
                }
                JointKind::Prismatic => {
                    origin = add(origin, scale(axis, q[j]));
                    (columns[0], columns[1])
                }
            };
            let z = columns[2];
            let rotation = std::array::from_fn(|r| [x[r], y[r], z[r]]);
            let axis = match joint.kind {
                JointKind::Revolute => Twist { turn: axis, slide: cross(origin, axis) },
                JointKind::Prismatic => Twist { turn: [Jet::ZERO; 3], slide: axis },
            };
            let inertia = in_base(&self.standard[j], &rotation, origin, mass_scale[j]);
            self.placed[j] = Placed { axis, rotation, origin, inertia };
        }
    }

    /// The torques C(q, q̇) q̇ + g(q) of the placed links.
    pub(crate) fn bias(&self, qd: &[Jet], out: &mut [Jet]) {
        let gravity = self.chain.gravity_m_s2().map(|g| Jet::constant(-g));
        let still = (Twist::default(), Twist { turn: [Jet::ZERO; 3], slide: gravity });
        let mut motions: Vec<(Twist, Twist)> = Vec::with_capacity(self.joints());
        let mut forces = Vec::with_capacity(self.joints());
        for (j, (placed, rate)) in self.placed.iter().zip(qd).enumerate() {
            let (velocity, acceleration) = self.chain.parent(j).map_or(still, |p| motions[p]);
            let own = placed.axis.times(*rate);
            let acceleration = acceleration.plus(velocity.carry(own));
            let velocity = velocity.plus(own);
            let momentum = placed.inertia.momentum(velocity);
            forces.push(placed.inertia.momentum(acceleration).plus(velocity.carry_momentum(momentum)));
            motions.push((velocity, acceleration));
        }
        for j in (0..self.joints()).rev() {
            out[j] = self.placed[j].axis.power(forces[j]);
            if let Some(parent) = self.chain.parent(j) {
                forces[parent] = forces[parent].plus(forces[j]);
            }
        }
    }

    /// The mass matrix of the placed links, row after row.
    pub(crate) fn mass_matrix(&self, out: &mut [Jet]) {
        let n = self.joints();
        out.fill(Jet::ZERO);
        let mut composite: Vec<Inertia> = self.placed.iter().map(|p| p.inertia).collect();
        for k in (0..n).rev() {
            let momentum = composite[k].momentum(self.placed[k].axis);
            if let Some(parent) = self.chain.parent(k) {
                composite[parent] = composite[parent].plus(&composite[k]);
            }
            let mut ancestor = Some(k);
            while let Some(j) = ancestor {
                let entry = self.placed[j].axis.power(momentum);
                out[j * n + k] = entry;
                out[k * n + j] = entry;
                ancestor = self.chain.parent(j);
            }
        }
    }

    /// A point of the last link, in the base frame, and its velocity per q̇ of each joint.
    pub(crate) fn point(&self, in_link_m: [f64; 3], jacobian: &mut [Vector]) -> Vector {
        let Some(last) = self.placed.last() else { return [Jet::ZERO; 3] };
        let point: Vector = std::array::from_fn(|r| {
            last.origin[r] + (0..3).fold(Jet::ZERO, |sum, c| sum + last.rotation[r][c] * in_link_m[c])
        });
        jacobian.fill([Jet::ZERO; 3]);
        let mut ancestor = self.joints().checked_sub(1);
        while let Some(j) = ancestor {
            let axis = &self.placed[j].axis;
            jacobian[j] = add(axis.slide, cross(axis.turn, point));
            ancestor = self.chain.parent(j);
        }
        point
    }
}

/// A link's parameters {XX XY XZ YY YZ ZZ mX mY mZ m}, about its frame's origin, as seen from the base.
fn in_base(standard: &[f64; 10], rotation: &[Vector; 3], origin: Vector, factor: Jet) -> Inertia {
    let [xx, xy, xz, yy, yz, zz, mx, my, mz, m] = *standard;
    let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let turned: [Vector; 3] = std::array::from_fn(|r| {
        std::array::from_fn(|c| (0..3).fold(Jet::ZERO, |sum, k| sum + rotation[r][k] * rows[k][c]))
    });
    let entry = |r: usize, c: usize| dot(turned[r], rotation[c]);
    let h: Vector = std::array::from_fn(|r| rotation[r][0] * mx + rotation[r][1] * my + rotation[r][2] * mz);
    // About the base: I + (h·o + o·h) 1 − h oᵀ − o hᵀ + m (o·o 1 − o oᵀ).
    let twice = dot(h, origin) * 2.0 + dot(origin, origin) * m;
    let shifted = |r: usize, c: usize| {
        let product = h[r] * origin[c] + origin[r] * h[c] + origin[r] * origin[c] * m;
        (if r == c { entry(r, c) + twice } else { entry(r, c) } - product) * factor
    };
    Inertia {
        mass: factor * m,
        moment: scale(std::array::from_fn(|r| h[r] + origin[r] * m), factor),
        inertia: [shifted(0, 0), shifted(0, 1), shifted(0, 2), shifted(1, 1), shifted(1, 2), shifted(2, 2)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aurt_rbd::{ChainDynamics, Joint, LinkBody, Parent, Placement};

    /// A tree of turning and sliding joints in no special position.
    pub(crate) fn arm() -> (SerialChain, Vec<f64>) {
        let place = |x: f64| Placement::from_roll_pitch_yaw([0.1 * x, -0.2, 0.3], [0.4 + x, -0.7 * x, 0.9]);
        let joints = vec![
            Joint::revolute(place(0.3)),
            Joint { theta_offset_rad: 0.4, sign: -1.0, ..Joint::revolute(place(0.8)) },
            Joint { theta_offset_rad: 0.2, ..Joint::prismatic(place(-0.4)) },
            // A branch: the third joint moves none of what follows.
            Joint { sign: -1.0, parent: Parent::Link(1), ..Joint::prismatic(place(0.6)) },
            Joint::revolute(place(-0.9)),
        ];
        let body = |k: f64| LinkBody {
            mass_kg: 1.0 + k,
            com_m: [0.1 * k, 0.2, -0.1],
            inertia_at_com_kg_m2: [0.03, 0.002 * k, -0.004, 0.05, 0.001, 0.04],
        };
        let standard = (0..5).flat_map(|k| body(f64::from(k)).standard_parameters()).collect();
        (SerialChain::new(joints, [1.0, -2.0, -9.0]).unwrap(), standard)
    }

    #[test]
    fn torques_are_those_of_newton_and_euler() {
        let (chain, standard) = arm();
        let n = chain.joints().len();
        let mut reference = ChainDynamics::new(chain.clone(), &standard).unwrap();
        let mut bodies = Bodies::new(&chain, &standard);
        let (q, qd) = ([0.3, -0.8, 0.2, -0.1, 1.4], [0.5, -1.1, 0.7, 0.4, -0.9]);
        let jets = |x: &[f64]| -> Vec<Jet> { x.iter().map(|x| Jet::constant(*x)).collect() };
        bodies.place(&jets(&q), &vec![Jet::constant(1.0); n]);
        let (mut bias, mut mass) = (vec![Jet::ZERO; n], vec![Jet::ZERO; n * n]);
        bodies.bias(&jets(&qd), &mut bias);
        bodies.mass_matrix(&mut mass);
        for k in 0..=n {
            let mut qdd = vec![0.0; n];
            if k < n {
                qdd[k] = 1.0;
            }
            let mut torque = vec![0.0; n];
            reference.inverse_dynamics(&q, &qd, &qdd, &mut torque);
            for j in 0..n {
                let own = bias[j].value + if k < n { mass[j * n + k].value } else { 0.0 };
                assert!((own - torque[j]).abs() < 1e-12, "joint {j}: {own} {}", torque[j]);
            }
        }
    }

    #[test]
    fn slopes_and_points_are_those_of_differences() {
        let (chain, standard) = arm();
        let n = chain.joints().len();
        let q = [0.3, -0.8, 0.2, -0.1, 1.4];
        let at = |step: f64| {
            let mut bodies = Bodies::new(&chain, &standard);
            let mut jets: Vec<Jet> = q.iter().map(|x| Jet::constant(*x)).collect();
            jets[1] = Jet::variable(q[1] + step, 2);
            bodies.place(&jets, &vec![Jet::constant(1.2); n]);
            let (mut bias, mut jacobian) = (vec![Jet::ZERO; n], vec![[Jet::ZERO; 3]; n]);
            bodies.bias(&vec![Jet::constant(0.4); n], &mut bias);
            let point = bodies.point([0.1, 0.2, 0.3], &mut jacobian);
            (bias, point, jacobian)
        };
        let (bias, point, jacobian) = at(0.0);
        let (above, below) = (at(1e-6), at(-1e-6));
        for j in 0..n {
            let difference = (above.0[j].value - below.0[j].value) / 2e-6;
            assert!((bias[j].slope[2] - difference).abs() < 1e-7, "{j}");
        }
        for r in 0..3 {
            assert!((point[r].slope[2] - jacobian[1][r].value).abs() < 1e-12);
        }
    }
}
