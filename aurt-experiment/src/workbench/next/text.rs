use aurt_diagnosis::discrimination::{Doubt, Outlook, Subject};
use aurt_report::rendering::text::wrapped;
use aurt_traits::RobotNames;
use serde_json::{Value, json};

use super::{Next, Open, Plan, SURE};

impl Next {
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        if self.open.is_empty() {
            text.push_str(if self.never.is_empty() {
                "nothing is open that a motion could decide\n"
            } else {
                "what is open cannot be decided by motions within these limits\n"
            });
        } else {
            text.push_str("open after the diagnosis, and the probability that a recording settles it\n");
            text.push_str(&format!(
                "  {:>13} {:>15} {:>14}\n",
                "this motion", "recorded again", "a multi-sine"
            ));
            for open in &self.open {
                let [this, again, generic] =
                    [&open.planned, &open.again, &open.generic].map(|o| format!("{:.2}", o.settled));
                let words = self.words(&open.doubt);
                text.push_str(&format!(
                    "  {this:>13} {again:>15} {generic:>14}   {words}{}\n",
                    self.more(open)
                ));
            }
        }
        self.add_never(&mut text);
        self.add_intervals(&mut text);
        if let Some(plan) = &self.motion {
            self.add_plan(plan, &mut text);
        }
        text.extend(self.notes.iter().map(|note| wrapped(&format!("note: {note}"))));
        text
    }

    fn add_never(&self, text: &mut String) {
        if self.never.is_empty() {
            return;
        }
        text.push_str("\nno motion within these limits settles\n");
        // The same effect on several joints is one line.
        let mut lines: Vec<(String, String, Vec<usize>)> = Vec::new();
        for (doubt, outlook) in &self.never {
            let (what, why, joints) = match doubt {
                Doubt::Absorbed(subject) => {
                    let why = format!(
                        "the model's own coefficients take up all but {:.1} % of its torque",
                        100.0 * outlook.free
                    );
                    (format!("`{}`", subject.id), why, subject.joints.clone())
                }
                _ => (self.words(doubt), self.reason(outlook), Vec::new()),
            };
            match lines.iter_mut().find(|(known, ..)| *known == what && !joints.is_empty()) {
                Some((_, _, all)) => all.extend(joints),
                None => lines.push((what, why, joints)),
            }
        }
        for (what, why, mut joints) in lines {
            joints.sort_unstable();
            joints.dedup();
            let on = if joints.is_empty() {
                String::new()
            } else {
                format!(" on {}", self.names().joint_list(&joints))
            };
            text.push_str(&wrapped(&format!("- {what}{on}: {why}")));
        }
    }

    fn add_intervals(&self, text: &mut String) {
        let mut is_first = true;
        for (subject, intervals) in &self.intervals {
            for interval in intervals {
                if std::mem::take(&mut is_first) {
                    text.push_str("\nstandard deviations, now and with this motion recorded\n");
                }
                text.push_str(&format!(
                    "  {:>10} {:>10}   {} of {}\n",
                    plain(interval.now),
                    plain(interval.after),
                    interval.parameter,
                    self.named(subject),
                ));
            }
        }
    }

    fn add_plan(&self, plan: &Plan, text: &mut String) {
        text.push_str(&format!("\nmotion of {:.1} s\n", plan.trajectory.duration_s()));
        text.extend(plan.pieces.iter().map(|piece| format!("  {piece}\n")));
        let what = if self.is_of_drives { "distance from the command" } else { "torque" };
        let shares = plan.largest.iter().filter(|[_, recorded]| *recorded > 0.0);
        let most = shares.map(|[planned, recorded]| planned / recorded).fold(0.0, f64::max);
        text.push_str(&format!("  largest predicted {what}: {most:.2} of the largest recorded\n"));
    }

    pub fn to_json(&self) -> Value {
        let outlook = |o: &Outlook| {
            json!({"settled": o.settled, "wrongly": o.wrongly, "nats": o.nats, "free": o.free, "interval": o.interval.as_ref().map(
                |i| json!({"parameter": i.parameter, "value": i.value, "std_now": i.now, "std_after": i.after}))})
        };
        let subject = |s: &Subject| json!({"effect": s.id, "joints": s.joints});
        let doubt = |doubt: &Doubt| match doubt {
            Doubt::Rivals { claimed, rival } => {
                json!({"kind": "rivals", "claimed": subject(claimed), "rival": subject(rival)})
            }
            Doubt::Indicated(s) => json!({"kind": "indicated", "subject": subject(s)}),
            Doubt::Absorbed(s) => json!({"kind": "absorbed", "subject": subject(s)}),
            Doubt::Wide(s, wanted) => {
                json!({"kind": "wide", "subject": subject(s), "parameter": wanted.parameter, "wanted_std": wanted.std})
            }
        };
        let open: Vec<Value> = self
            .open
            .iter()
            .map(|open| {
                json!({
                    "doubt": doubt(&open.doubt),
                    "planned": outlook(&open.planned),
                    "recorded_again": outlook(&open.again),
                    "multi_sine": outlook(&open.generic),
                })
            })
            .collect();
        let never: Vec<Value> =
            self.never.iter().map(|(d, o)| json!({"doubt": doubt(d), "outlook": outlook(o)})).collect();
        let intervals: Vec<Value> = self
            .intervals
            .iter()
            .flat_map(|(s, intervals)| {
                intervals.iter().map(move |i| {
                    json!({
                        "subject": subject(s), "parameter": i.parameter, "value": i.value,
                        "std_now": i.now, "std_after": i.after,
                    })
                })
            })
            .collect();
        json!({
            "open": open,
            "never": never,
            "intervals": intervals,
            "motion": self.motion.as_ref().map(|plan| json!({
                "duration_s": plan.trajectory.duration_s(),
                "pieces": plan.pieces,
                (if self.is_of_drives { "largest_distance_rad" } else { "largest_torque" }):
                    plan.largest.iter().map(|t| t[0]).collect::<Vec<_>>(),
                "largest_recorded": plan.largest.iter().map(|t| t[1]).collect::<Vec<_>>(),
            })),
            "notes": self.notes,
        })
    }

    fn names(&self) -> RobotNames<'_> {
        RobotNames { joints: &self.joint_names, links: &[] }
    }

    fn named(&self, subject: &Subject) -> String {
        if subject.is_whole_arm {
            return format!("`{}`", subject.id);
        }
        format!("`{}` on {}", subject.id, self.names().joint_list(&subject.joints))
    }

    fn words(&self, doubt: &Doubt) -> String {
        match doubt {
            Doubt::Rivals { claimed, rival } if claimed.joints == rival.joints => {
                format!("`{}` or {}", claimed.id, self.named(rival))
            }
            Doubt::Rivals { claimed, rival } => {
                format!("{} or {}", self.named(claimed), self.named(rival))
            }
            Doubt::Indicated(subject) | Doubt::Absorbed(subject) => {
                format!("{} or nothing", self.named(subject))
            }
            Doubt::Wide(subject, wanted) => {
                format!("{} of {} to ± {}", wanted.parameter, self.named(subject), wanted.std)
            }
        }
    }

    /// Why no motion that was tried settles a doubt.
    fn reason(&self, outlook: &Outlook) -> String {
        match &outlook.interval {
            Some(interval) => {
                format!("with all motions that were tried the deviation is {}", plain(interval.after))
            }
            None if self.is_of_drives => format!(
                "with its numbers estimated again, one model follows the other to {} of what a model is expected to miss",
                plain(outlook.free)
            ),
            None => format!(
                "one explanation follows the other to {:.1} % of its torque in all motions that were tried",
                100.0 * outlook.free
            ),
        }
    }

    /// How much of the motion a doubt would take that one does not settle.
    fn more(&self, open: &Open) -> String {
        let (Some(nats), Some(plan)) = (open.planned.nats, &self.motion) else { return String::new() };
        let times = self.sure_nats / nats.max(f64::MIN_POSITIVE);
        if times <= 1.0 {
            return String::new();
        }
        format!(" ({:.0} s of it for {SURE})", times * plan.trajectory.duration_s())
    }
}

/// A positive number with two significant digits.
fn plain(value: f64) -> String {
    if !(value.is_finite() && value > 0.0) {
        return value.to_string();
    }
    let digits = (1.0 - value.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}
