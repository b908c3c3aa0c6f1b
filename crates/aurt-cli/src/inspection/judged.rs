//! Which parameters of a model a motion determines, by their names.

use aurt_traits::RobotModel;
use serde_json::{Value, json};

use super::excitation::{Excitation, Excited};
use crate::{
    rendering::{number::significant, text::wrapped},
    reports::recording::Excited as ExcitedNames,
};

/// A parameter whose column is imitated by others up to this share of its own is hard to tell from them.
const SMALL_OWN_SHARE: f64 = 0.02;

/// The excitation of a model's parameters by a motion.
pub struct Judged {
    /// The model.
    pub model: RobotModel,
    /// What the motion says of its coefficients.
    pub excited: Excited,
}

impl Judged {
    /// The same by names.
    pub fn named(&self) -> ExcitedNames<'_> {
        let own = |(k, e): (usize, &Excitation)| match e {
            Excitation::Own(share) => Some((self.model.parameters()[k].name.as_str(), *share)),
            _ => None,
        };
        ExcitedNames {
            determined: self.excited.coefficients.iter().enumerate().filter_map(own).collect(),
            combined: self.combined(),
            silent: self.silent(),
            condition_number: self.excited.condition_number,
        }
    }

    /// The names of the parameters that `choose` takes.
    fn names(&self, choose: impl Fn(&Excitation) -> bool) -> Vec<&str> {
        let parameters = self.model.parameters().iter().zip(&self.excited.coefficients);
        parameters.filter(|(_, e)| choose(e)).map(|(p, _)| p.name.as_str()).collect()
    }

    /// Parameters that the motion does not need.
    pub fn silent(&self) -> Vec<&str> {
        self.names(|e| *e == Excitation::Silent)
    }

    /// Parameters that are determined in combinations only.
    pub fn combined(&self) -> Vec<&str> {
        self.names(|e| matches!(e, Excitation::Combined(_)))
    }

    fn weak(&self) -> Vec<&str> {
        self.names(|e| matches!(e, Excitation::Own(share) if *share < SMALL_OWN_SHARE))
    }

    /// For people.
    pub fn to_text(&self) -> String {
        let total = self.model.parameters().len();
        let (silent, combined, weak) = (self.silent(), self.combined(), self.weak());
        let mut text = wrapped(&format!(
            "{total} parameters ({} base parameters, Coulomb and viscous friction of every joint): {} determined, {} \
             only in combinations, {} out of reach",
            self.model.base().len(),
            total - combined.len() - silent.len(),
            combined.len(),
            silent.len()
        ));
        text.push_str(&wrapped(&format!(
            "condition number of what is determined: {}",
            significant(self.excited.condition_number, 3)
        )));
        for (what, names) in
            [("out of reach", silent), ("only in combinations", combined), ("hard to tell apart", weak)]
        {
            if !names.is_empty() {
                text.push_str(&wrapped(&format!("{what}: {}", names.join(", "))));
            }
        }
        text
    }

    /// For programs.
    pub fn to_json(&self) -> Value {
        let parameters = self.model.parameters();
        let describe = |(k, excitation): (usize, &Excitation)| match excitation {
            Excitation::Own(share) => {
                json!({ "name": parameters[k].name, "is": "determined", "own_share": share })
            }
            Excitation::Combined(with) => {
                let with: Vec<&str> = with.iter().map(|w| parameters[*w].name.as_str()).collect();
                json!({ "name": parameters[k].name, "is": "combined", "with": with })
            }
            Excitation::Silent => json!({ "name": parameters[k].name, "is": "out_of_reach" }),
        };
        json!({
            "base_parameters": self.model.base().len(),
            "rank": self.excited.rank,
            "condition_number": self.excited.condition_number,
            "parameters": self.excited.coefficients.iter().enumerate().map(describe).collect::<Vec<_>>(),
        })
    }
}
