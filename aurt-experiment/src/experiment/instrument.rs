use super::{joint_count::JointCheck, section::Section};

/// `[instrument]`: what is known of the instrument that measured the joints.
///
/// Preprocessing makes of joint j's raw measurement y_j(t) = (raw_j(t + delay_s\[j\]) − offsets\[j\]) / gains\[j\];
/// torque constants, if the robot has them, multiply that.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Instrument {
    /// `gains`: measured per true value, one per joint, 1 by default.
    pub gains: Option<Vec<f64>>,
    /// `offsets`: what the instrument shows at zero, one per joint, in the raw unit, 0 by default.
    pub offsets: Option<Vec<f64>>,
    /// `delay_s`: how much the measurement lags behind the positions, one per joint, 0 by default.
    pub delay_s: Option<Vec<f64>>,
}

impl Instrument {
    pub(super) fn read(mut section: Section<'_, '_>) -> Self {
        let gains = per_joint(&mut section, "gains", |x| x != 0.0, "must not be zero");
        let offsets = per_joint(&mut section, "offsets", |_| true, "");
        let delay_s = per_joint(&mut section, "delay_s", |_| true, "");
        section.finish();
        Self { gains, offsets, delay_s }
    }
}

fn per_joint(
    section: &mut Section<'_, '_>,
    key: &'static str,
    allowed: impl Fn(f64) -> bool,
    otherwise: &str,
) -> Option<Vec<f64>> {
    let node = section.take(key)?;
    let values = section.numbers_of(key, node)?;
    if !values.iter().all(|x| allowed(*x)) {
        section.complain(key, node, otherwise, None);
        return None;
    }
    section.reader.check_joints(JointCheck::Length {
        key: key.to_owned(),
        found: values.len(),
        span: node.span.clone(),
    });
    Some(values)
}
