//! One step of an arm with drives and dry friction.
//!
//! # Equation
//! The velocities at the end of a step h solve
//!
//! (M + ½ h D) q̇⁺ = (M + ½ h D) q̇ + h (τ − F_v q̇ − b) − h F σ,  σ_j ∈ Sgn(q̇⁺_j)
//!
//! with the drives' torques τ at q̇, D the damping of drives and joints and b the torques of gravity, velocities and floor: the
//! trapezoidal rule for everything smooth, dry friction as an inclusion at the end of the step. A joint whose friction suffices
//! stands exactly still, without creep. M and b are evaluated once a sample, at the predicted middle of it.
//!
//! Which joints slide is found in numbers by projected Gauss–Seidel, then the sliding joints' equations are solved in jets, so
//! that derivatives are those of the branch that is taken.
//!
//! # Source
//! Moreau (1988), *Unilateral contact and dry friction in finite freedom dynamics*; Acary and Brogliato (2008), *Numerical
//! methods for nonsmooth dynamical systems*, chapter 10.

use aurt_traits::{DriveInput, Jet};

use crate::drives::DrivenArm;
use crate::drives::bodies::Bodies;

/// Sweeps of the search for the sliding joints, and the change of velocity in rad/s at which it ends.
const SWEEPS: (usize, f64) = (200, 1e-12);
/// Speed in m/s above which the floor's friction is that of sliding; below it, it is viscous.
const FLOOR_SLIDES_M_S: f64 = 2e-4;

/// The numbers of a joint's mechanics, in the order of their declaration.
#[derive(Debug, Clone, Copy)]
struct Numbers {
    rotor: Jet,
    coulomb: Jet,
    per_load: Jet,
    excess: Jet,
    stribeck: Jet,
    viscous: Jet,
    asymmetry: Jet,
    offset: Jet,
    zero: Jet,
    lower: Jet,
    upper: Jet,
}

/// What the floor does to the joints, linear about the middle of a sample.
#[derive(Debug, Clone, Default)]
struct Touch {
    /// Height of the point above the floor, and its derivatives by the joints along the normal and two tangents.
    height: Jet,
    rows: [Vec<Jet>; 3],
    stiffness: Jet,
    friction: Jet,
    at: Vec<Jet>,
    point_m: [f64; 3],
}

pub(crate) struct Plant<'a> {
    arm: &'a DrivenArm,
    drives: Vec<Vec<Jet>>,
    joints: Vec<Numbers>,
    mass_scale: Vec<Jet>,
    touch: Option<(Touch, Jet)>,
    bodies: Bodies,
    pub q: Vec<Jet>,
    pub qd: Vec<Jet>,
    drive_states: Vec<Vec<Jet>>,
    mass: Vec<Jet>,
    bias: Vec<Jet>,
}

impl<'a> Plant<'a> {
    /// An arm at rest at `q`, its drives at rest under `commands`; `numbers` are those of the arm as jets.
    pub fn new(arm: &'a DrivenArm, numbers: &[Jet], q: Vec<Jet>, commands: &[f64]) -> Self {
        let mut rest = numbers.iter().copied();
        let (mut drives, mut joints, mut mass_scale) = (Vec::new(), Vec::new(), Vec::new());
        for joint in &arm.joints {
            drives.push(rest.by_ref().take(joint.drive.parameters().len()).collect());
            let mut next = || rest.next().unwrap_or_default();
            let (rotor, coulomb, per_load, excess, stribeck) = (next(), next(), next(), next(), next());
            let (viscous, asymmetry, offset, zero) = (next(), next(), next(), next());
            mass_scale.push(next());
            let (lower, upper) = (next(), next());
            joints.push(Numbers {
                rotor,
                coulomb,
                per_load,
                excess,
                stribeck,
                viscous,
                asymmetry,
                offset,
                zero,
                lower,
                upper,
            });
        }
        let n = joints.len();
        let touch = arm.floor.map(|floor| {
            let mut next = || rest.next().unwrap_or_default();
            let (height, stiffness, friction) = (next(), next(), next());
            let point_m = [floor.x_m, floor.y_m, floor.z_m];
            (Touch { stiffness, friction, point_m, ..Touch::default() }, height)
        });
        Self {
            arm,
            drives,
            joints,
            mass_scale,
            touch,
            bodies: Bodies::new(&arm.chain, &arm.standard_parameters),
            qd: vec![Jet::ZERO; n],
            q,
            drive_states: arm.joints.iter().zip(commands).map(|(j, c)| j.drive.initial_state(*c)).collect(),
            mass: vec![Jet::ZERO; n * n],
            bias: vec![Jet::ZERO; n],
        }
    }

    /// Moves on by `substeps` steps of `step_s` from `time_s`; `command` is each joint's by time.
    pub fn sample(
        &mut self,
        time_s: f64,
        step_s: f64,
        substeps: usize,
        command: &dyn Fn(usize, Jet, f64) -> Jet,
    ) {
        self.bodies_at_middle(0.5 * step_s * substeps as f64);
        for k in 0..substeps {
            self.step(time_s + (k as f64 + 0.5) * step_s, step_s, command);
        }
    }

    /// M, b and the floor where the joints will be in `ahead_s`.
    fn bodies_at_middle(&mut self, ahead_s: f64) {
        let n = self.q.len();
        let at: Vec<Jet> = (0..n).map(|j| self.q[j] + self.qd[j] * ahead_s).collect();
        let coordinates: Vec<Jet> = (0..n).map(|j| at[j] + self.joints[j].zero).collect();
        self.bodies.place(&coordinates, &self.mass_scale);
        self.bodies.bias(&self.qd, &mut self.bias);
        self.bodies.mass_matrix(&mut self.mass);
        let Some((touch, height)) = &mut self.touch else { return };
        let mut jacobian = vec![[Jet::ZERO; 3]; n];
        let point = self.bodies.point(touch.point_m, &mut jacobian);
        let [normal, first, second] = directions(self.arm.chain.gravity_m_s2());
        let along = |v: &[Jet; 3], d: &[f64; 3]| v[0] * d[0] + v[1] * d[1] + v[2] * d[2];
        touch.height = along(&point, &normal) - *height;
        touch.rows = [normal, first, second].map(|d| jacobian.iter().map(|v| along(v, &d)).collect());
        touch.at = at;
    }

    fn step(&mut self, time_s: f64, h: f64, command: &dyn Fn(usize, Jet, f64) -> Jet) {
        let n = self.q.len();
        let mut load = self.bias.clone();
        let mut matrix = self.mass.clone();
        let implicit =
            self.touch.as_ref().and_then(|(touch, _)| touch.press(&self.q, &self.qd, h, &mut load));
        let mut right = vec![Jet::ZERO; n];
        let mut level = vec![Jet::ZERO; n];
        for j in 0..n {
            let numbers = &self.joints[j];
            let velocity = self.qd[j];
            let input = DriveInput {
                time_s,
                step_s: h,
                command: &|t, window_s| command(j, t, window_s),
                position_rad: self.q[j] + velocity * (0.5 * h),
                velocity_rad_s: velocity,
            };
            let driven = self.arm.joints[j].drive.torque(&self.drives[j], &input, &mut self.drive_states[j]);
            let viscous = if velocity.value < 0.0 {
                numbers.viscous - numbers.asymmetry
            } else {
                numbers.viscous + numbers.asymmetry
            };
            matrix[j * n + j] += numbers.rotor + (driven.damping + viscous) * (0.5 * h);
            right[j] = (driven.torque + numbers.offset - viscous * velocity - load[j]) * h;
            level[j] = numbers.coulomb + numbers.per_load * load[j].abs();
            if numbers.excess.value > 0.0 || numbers.excess.slope != [0.0; Jet::LANES] {
                // Friction that falls with speed makes derivatives grow without bound from slip to slip, as the phase of
                // stick–slip does in the robot. They are taken at the speed as simulated.
                let relative = Jet::constant(velocity.value) / numbers.stribeck;
                level[j] += numbers.excess * (-(relative * relative)).exp();
            }
            level[j] = level[j] * h;
        }
        for j in 0..n {
            if self.qd[j].value != 0.0 {
                for k in 0..n {
                    right[k] += matrix[k * n + j] * self.qd[j];
                }
            }
        }
        if let Some(implicit) = implicit {
            matrix.iter_mut().zip(implicit).for_each(|(m, i)| *m += i);
        }
        let before = std::mem::take(&mut self.qd);
        let sliding = self.sliding(&matrix, &right, &level);
        self.qd = solve(&matrix, &right, &level, &sliding);
        for j in 0..n {
            let numbers = &self.joints[j];
            self.q[j] += (before[j] + self.qd[j]) * (0.5 * h);
            let stop = if self.q[j].value < numbers.lower.value {
                numbers.lower
            } else if self.q[j].value > numbers.upper.value {
                numbers.upper
            } else {
                continue;
            };
            (self.q[j], self.qd[j]) = (stop, Jet::ZERO);
        }
    }

    /// The direction in which each joint slides; zero of one that stands.
    fn sliding(&self, matrix: &[Jet], right: &[Jet], level: &[Jet]) -> Vec<f64> {
        let n = right.len();
        if (0..n).all(|j| right[j].value.abs() <= level[j].value) {
            return vec![0.0; n];
        }
        let mut velocity = vec![0.0; n];
        for _ in 0..SWEEPS.0 {
            let mut change: f64 = 0.0;
            for j in 0..n {
                let others: f64 =
                    (0..n).filter(|k| *k != j).map(|k| matrix[j * n + k].value * velocity[k]).sum();
                let left = right[j].value - others;
                let mut next = if left.abs() <= level[j].value {
                    0.0
                } else {
                    (left - level[j].value.copysign(left)) / matrix[j * n + j].value
                };
                let (at, numbers) = (self.q[j].value, &self.joints[j]);
                if (at <= numbers.lower.value && next < 0.0) || (at >= numbers.upper.value && next > 0.0) {
                    next = 0.0;
                }
                change = change.max((next - velocity[j]).abs());
                velocity[j] = next;
            }
            if change <= SWEEPS.1 {
                break;
            }
        }
        velocity.iter().map(|v| if *v == 0.0 { 0.0 } else { v.signum() }).collect()
    }
}

impl Touch {
    /// Subtracts the floor's forces at the positions from `load`, the torques that the drives have to overcome, and returns what
    /// the floor adds to the matrix of a step: its elasticity and friction count at the end of the step. None without touch.
    fn press(&self, q: &[Jet], qd: &[Jet], h: f64, load: &mut [Jet]) -> Option<Vec<Jet>> {
        let n = q.len();
        let along =
            |row: &[Jet], of: &dyn Fn(usize) -> Jet| (0..n).fold(Jet::ZERO, |sum, j| sum + row[j] * of(j));
        let depth = -self.height - along(&self.rows[0], &|j| q[j] - self.at[j]);
        if depth.value <= 0.0 {
            return None;
        }
        let normal = self.stiffness * depth;
        let [x, y] = [1, 2].map(|d| along(&self.rows[d], &|j| qd[j]).value);
        let drag = self.friction * normal * (h / libm::hypot(x, y).max(FLOOR_SLIDES_M_S));
        let weights = [self.stiffness * (h * h), drag, drag];
        let mut matrix = vec![Jet::ZERO; n * n];
        for j in 0..n {
            load[j] -= normal * self.rows[0][j];
            for (row, weight) in self.rows.iter().zip(weights) {
                let own = weight * row[j];
                for k in 0..n {
                    matrix[j * n + k] += own * row[k];
                }
            }
        }
        Some(matrix)
    }
}

/// The direction against gravity and two across it.
fn directions(gravity: [f64; 3]) -> [[f64; 3]; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let unit = |v: [f64; 3]| {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| x / length.max(1e-12))
    };
    let normal = unit(gravity.map(|g| -g));
    let other = if normal[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let first = unit(cross(normal, other));
    [normal, first, cross(normal, first)]
}

/// The velocities with the sliding joints' friction at its level, the others at rest (elimination without pivots: the matrix is
/// symmetric and positive).
fn solve(matrix: &[Jet], right: &[Jet], level: &[Jet], sliding: &[f64]) -> Vec<Jet> {
    let n = right.len();
    let moving: Vec<usize> = (0..n).filter(|j| sliding[*j] != 0.0).collect();
    let m = moving.len();
    let mut a: Vec<Jet> = Vec::with_capacity(m * m);
    for j in &moving {
        a.extend(moving.iter().map(|k| matrix[j * n + k]));
    }
    let mut b: Vec<Jet> = moving.iter().map(|j| right[*j] - level[*j] * sliding[*j]).collect();
    for k in 0..m {
        let inverse = Jet::constant(1.0) / a[k * m + k];
        for j in k + 1..m {
            let factor = a[j * m + k] * inverse;
            if factor.value != 0.0 {
                for c in k + 1..m {
                    let part = factor * a[k * m + c];
                    a[j * m + c] -= part;
                }
                let part = factor * b[k];
                b[j] -= part;
            }
        }
    }
    let mut out = vec![Jet::ZERO; n];
    for k in (0..m).rev() {
        let mut sum = b[k];
        for c in k + 1..m {
            sum -= a[k * m + c] * out[moving[c]];
        }
        out[moving[k]] = sum / a[k * m + k];
    }
    out
}
