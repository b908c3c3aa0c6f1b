use aurt_traits::{Dispatch, MotionView};

use super::lanes::{self, Lanes, Plain2};
use super::motion::{GROUP, JointLanes, Kept, LinkMotion, Twist, joint_angles};
use super::plan::Plan;
use super::turn::{Vector, dot};
use super::{FEW_JOINTS, Groups, advance};
use crate::{INERTIAL_PARAMETERS, JointKind, SerialChain};

/// Where torques go: joint after joint, and the distance between two joints' first samples.
type Output<'a> = (&'a mut [f64], usize);

/// Writes τ = Y π for every sample of `motion`, π the standard parameters.
///
/// A link's parameters and motion give one wrench, which is projected on the unit twists of the joints of its path: a
/// quarter of the work of the columns of Y. Lanes are independent of one another.
pub(crate) fn torque(
    level: Dispatch,
    chain: &SerialChain,
    motion: MotionView<'_>,
    standard: &[f64],
    out: Output<'_>,
) {
    let plan = Plan::without_tile(chain, motion);
    let (links, _) = standard.as_chunks::<INERTIAL_PARAMETERS>();
    match level {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has the features that the function was compiled for.
        Dispatch::Avx512 if level.is_available() => unsafe { torque_avx512(&plan, links, out) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Dispatch::Avx2 if level.is_available() => unsafe { torque_avx2(&plan, links, out) },
        _ => torque_lanes::<Plain2>(&plan, links, out),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
fn torque_avx512(plan: &Plan<'_>, standard: &[[f64; INERTIAL_PARAMETERS]], out: Output<'_>) {
    torque_lanes::<lanes::Fused8>(plan, standard, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn torque_avx2(plan: &Plan<'_>, standard: &[[f64; INERTIAL_PARAMETERS]], out: Output<'_>) {
    torque_lanes::<lanes::Fused4>(plan, standard, out);
}

/// What is remembered of each joint: its twists and angles, and its torques so far.
#[derive(Clone, Copy)]
struct Memory<T> {
    joints: [JointLanes<T>; FEW_JOINTS],
    torques: [[T; GROUP]; FEW_JOINTS],
}

#[inline(always)]
fn torque_lanes<T: Lanes>(
    plan: &Plan<'_>,
    standard: &[[f64; INERTIAL_PARAMETERS]],
    (out, stride): Output<'_>,
) {
    let (count, samples) = (plan.joints.len(), plan.samples);
    if samples == 0 || count == 0 {
        return;
    }
    let zero = T::splat(0.0);
    let mut few = Memory { joints: [JointLanes::zero(); FEW_JOINTS], torques: [[zero; GROUP]; FEW_JOINTS] };
    let (mut many_joints, mut many_torques) = (Vec::new(), Vec::new());
    let (joints, torques) = if count <= FEW_JOINTS {
        (&mut few.joints[..count], &mut few.torques[..count])
    } else {
        many_joints.resize(count, JointLanes::zero());
        many_torques.resize(count, [zero; GROUP]);
        (&mut many_joints[..], &mut many_torques[..])
    };
    let few_samples = samples < T::LANES;
    let padded = if few_samples { plan.padded_series(T::LANES) } else { Vec::new() };
    let whole = few_samples.then(|| plan.with_series(&padded, T::LANES));
    let mut values = vec![0.0; if few_samples { count * T::LANES } else { 0 }];
    let plan = whole.as_ref().unwrap_or(plan);
    let mut kept = plan.kept();
    let mut groups = Groups::new(plan.samples, T::LANES, 0);
    while let Some(group) = groups.next() {
        let to = if few_samples { (&mut values[..], T::LANES) } else { (&mut *out, stride) };
        torque_group(plan, standard, group, (&mut *joints, &mut kept), torques, to);
    }
    for (joint, lanes) in values.chunks_exact(T::LANES).enumerate() {
        out[joint * stride..joint * stride + samples].copy_from_slice(&lanes[..samples]);
    }
}

#[inline(always)]
fn torque_group<T: Lanes>(
    plan: &Plan<'_>,
    standard: &[[f64; INERTIAL_PARAMETERS]],
    group: &[usize],
    (joints, kept): (&mut [JointLanes<T>], &mut [Kept<T>]),
    torques: &mut [[T; GROUP]],
    (out, stride): Output<'_>,
) {
    let mut links = [LinkMotion::zero(); GROUP];
    for ((lanes, joint), [position, ..]) in joints.iter_mut().zip(plan.joints).zip(&plan.series) {
        joint_angles(joint, position, group, &mut lanes.angles);
    }
    for (i, joint) in plan.joints.iter().enumerate() {
        advance(plan, i, group, joints, &mut links, kept);
        let sign = T::splat(joint.sign);
        let carriers = plan.carriers_of(i);
        for (member, link) in links.iter().enumerate().take(group.len()) {
            let wrench = wrench(link, &standard[i]);
            torques[i][member] = match joint.kind {
                JointKind::Revolute => wrench.moment[2] * sign,
                JointKind::Prismatic => wrench.force[2] * sign,
            };
            for (carrier, joint) in carriers.iter().zip(&*joints) {
                let torque = &mut torques[*carrier][member];
                *torque = wrench.along(&joint.twists[member], *torque);
            }
        }
    }
    for (joint, torque) in torques.iter().enumerate() {
        for (torque, first) in torque.iter().zip(group) {
            let to = &mut out[joint * stride + first..joint * stride + first + T::LANES];
            // SAFETY: the slice has as many values as there are lanes.
            unsafe { torque.store_at(to.as_mut_ptr()) };
        }
    }
}

/// What a link needs of force and moment about its frame's origin.
#[derive(Clone, Copy)]
struct Wrench<T> {
    force: Vector<T>,
    moment: Vector<T>,
}

impl<T: Lanes> Wrench<T> {
    #[inline(always)]
    fn along(&self, twist: &Twist<T>, sum: T) -> T {
        let [sx, sy, sz] = twist.omega;
        let [vx, vy, vz] = twist.velocity;
        let turning = sx.mul_add(self.moment[0], sy.mul_add(self.moment[1], sz.mul_add(self.moment[2], sum)));
        vx.mul_add(self.force[0], vy.mul_add(self.force[1], vz.mul_add(self.force[2], turning)))
    }
}

/// The force m a + B h and the moment I ω̇ + ω × I ω + h × a of a link of inertia I about the origin, first moment h
/// and mass m.
#[inline(always)]
fn wrench<T: Lanes>(link: &LinkMotion<T>, standard: &[f64; INERTIAL_PARAMETERS]) -> Wrench<T> {
    let derived = link.derived();
    let [dx, dy, dz] = link.omega_dot;
    let [ax, ay, az] = link.accel;
    let [xy, xz, yz] = derived.products;
    let [xx_yy, zz_xx, yy_zz] = derived.differences;
    let [[_, b01, b02], [b10, _, b12], [b20, b21, _]] = derived.b;
    let [ixx, ixy, ixz, iyy, iyz, izz, hx, hy, hz, m] = *standard;
    let (h, m) = ([T::splat(hx), T::splat(hy), T::splat(hz)], T::splat(m));
    let (ixy, ixz, iyz) = (T::splat(ixy), T::splat(ixz), T::splat(iyz));
    let force = [
        m.mul_add(link.accel[0], dot(&derived.b[0], &h)),
        m.mul_add(link.accel[1], dot(&derived.b[1], &h)),
        m.mul_add(link.accel[2], dot(&derived.b[2], &h)),
    ];
    let moment = [
        T::splat(izz - iyy)
            .mul_add(yz, iyz.mul_add(yy_zz, ixz.mul_add(b10, ixy.neg_mul_add(b20, T::splat(ixx) * dx)))),
        T::splat(ixx - izz)
            .mul_add(xz, ixz.mul_add(zz_xx, ixy.mul_add(b21, iyz.neg_mul_add(b01, T::splat(iyy) * dy)))),
        T::splat(iyy - ixx)
            .mul_add(xy, ixy.mul_add(xx_yy, iyz.mul_add(b02, ixz.neg_mul_add(b12, T::splat(izz) * dz)))),
    ];
    let moment = [
        h[1].mul_add(az, h[2].neg_mul_add(ay, moment[0])),
        h[2].mul_add(ax, h[0].neg_mul_add(az, moment[1])),
        h[0].mul_add(ay, h[1].neg_mul_add(ax, moment[2])),
    ];
    Wrench { force, moment }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Uniform;
    use crate::{MdhRows, MdhTable};
    use aurt_traits::{Motion, Parameter, RegressorTile, RigidBodyRegressor};
    use serde::{Deserialize, Serialize};

    /// Senses, offsets and twists of all kinds.
    const ARM: &str = "alpha,a,d,theta\n0.3,0.1,0.2,0.4\npi/2,-0.4,0,0\n0,0.3,0.1,1\n-pi/2,0.05,0.4,0\n\
                       pi/2,0,0.3,0\n0.7,0.2,-0.1,-0.5\n0,0.3,0.1,1\n-pi/2,0.05,0.4,0\npi/2,0,0.3,0\n";

    /// A regressor without a quicker way to its torques.
    #[derive(Debug, Clone, Serialize, Deserialize)]
    struct OnlyColumns(SerialChain);

    #[typetag::serde(name = "only_columns")]
    impl RigidBodyRegressor for OnlyColumns {
        fn joints(&self) -> usize {
            RigidBodyRegressor::joints(&self.0)
        }

        fn standard_parameters(&self) -> Vec<Parameter> {
            self.0.standard_parameters()
        }

        fn loads(&self, parameter: usize, joint: usize) -> bool {
            self.0.loads(parameter, joint)
        }

        fn evaluate(&self, motion: MotionView<'_>, out: &mut RegressorTile<'_>) {
            self.0.evaluate(motion, out);
        }

        fn gravity_m_s2(&self) -> [f64; 3] {
            self.0.gravity_m_s2()
        }

        fn with_gravity(&self, gravity_m_s2: [f64; 3]) -> Box<dyn RigidBodyRegressor> {
            self.0.with_gravity(gravity_m_s2)
        }
    }

    #[test]
    fn is_the_regressor_times_the_parameters_on_every_instruction_set() {
        let mut random = Uniform::from_seed(7);
        for joints in [1, 6, 9] {
            let rows: Vec<&str> = ARM.lines().take(joints + 1).collect();
            let table = MdhTable::parse(&rows.join("\n"), "arm", MdhRows::Next).unwrap();
            let chain = SerialChain::from_mdh(&table, [1.0, -2.0, -9.0]).unwrap();
            let mut numbers =
                |n: usize, reach: f64| -> Vec<f64> { (0..n).map(|_| random.within(reach)).collect() };
            let standard = numbers(10 * joints, 2.0);
            // An interpreter takes its time.
            let samples: &[usize] = if cfg!(miri) { &[0, 1, 3] } else { &[0, 1, 3, 8, 13, 100] };
            for &samples in samples {
                let n = joints * samples;
                let motion = Motion::new(
                    joints,
                    vec![0.0; samples],
                    numbers(n, 3.0),
                    numbers(n, 2.0),
                    numbers(n, 9.0),
                )
                .unwrap();
                let stride = samples + 3;
                let mut fused: Option<Vec<f64>> = None;
                for level in Dispatch::available() {
                    let mut torque = vec![f64::NAN; joints * stride];
                    chain.torque_on(level, motion.view(), &standard, &mut torque, stride);
                    for k in 0..samples {
                        let at = |of: &dyn Fn(usize) -> f64| (0..joints).map(of).collect::<Vec<_>>();
                        let view = motion.view();
                        let y = chain.regressor(
                            &at(&|j| view.position_rad(j)[k]),
                            &at(&|j| view.velocity_rad_s(j)[k]),
                            &at(&|j| view.acceleration_rad_s2(j)[k]),
                        );
                        for (joint, row) in y.chunks_exact(10 * joints).enumerate() {
                            let terms: Vec<f64> = row.iter().zip(&standard).map(|(y, p)| y * p).collect();
                            let (sum, size) =
                                (terms.iter().sum::<f64>(), terms.iter().map(|t| t.abs()).sum::<f64>());
                            let difference = torque[joint * stride + k] - sum;
                            assert!(difference.abs() <= 1e-13 * size, "{level} {joint} {k} {difference:e}");
                        }
                    }
                    if level != Dispatch::Baseline {
                        let same = fused.get_or_insert_with(|| torque.clone()).iter().zip(&torque);
                        assert!(same.into_iter().all(|(a, b)| a.to_bits() == b.to_bits()), "{level}");
                    }
                }
                let mut general = vec![0.0; joints * stride];
                OnlyColumns(chain.clone()).torque(motion.view(), &standard, &mut general, stride);
                for (a, b) in general.iter().zip(fused.unwrap_or_default()).filter(|(_, b)| b.is_finite()) {
                    assert!((a - b).abs() < 1e-10, "{a} {b}");
                }
            }
        }
    }
}
