use aurt_plugins::{Node, Registry, SlotModel};
use aurt_traits::{CoulombModel, HysteresisModel, JointStack, ModelError, Slot, ViscousBasis};
use serde_json::json;

use super::{
    errors::Complaint,
    joint_count::{JointCheck, repeated},
    section::{Reader, Section},
};

/// `[joint_dynamics]`: the friction of every joint, τ_JD = f_C(τ_J)·H(z, q̇) + f_v(q̇) (equation 6), with
/// exceptions for some.
#[derive(Debug, Clone)]
pub struct JointDynamics {
    /// `coulomb`: f_C; by default `constant`.
    pub coulomb: Box<dyn CoulombModel>,
    /// `hysteresis`: H; by default `sign`.
    pub hysteresis: Box<dyn HysteresisModel>,
    /// `viscous`: f_v; by default `polynomial` of power 1.
    pub viscous: Box<dyn ViscousBasis>,
    /// `[[joint_dynamics.override]]`: the exceptions.
    pub overrides: Vec<JointOverride>,
}

/// `[[joint_dynamics.override]]`: other models for some joints; what it does not give stays as for every joint.
#[derive(Debug, Clone)]
pub struct JointOverride {
    /// `joints`, from 0.
    pub joints: Vec<usize>,
    pub coulomb: Option<Box<dyn CoulombModel>>,
    pub hysteresis: Option<Box<dyn HysteresisModel>>,
    pub viscous: Option<Box<dyn ViscousBasis>>,
}

/// The tables that models of one `[joint_dynamics]` or override were built from.
#[derive(Debug, Clone, Copy, Default)]
struct Tables<'n> {
    coulomb: Option<&'n Node>,
    hysteresis: Option<&'n Node>,
    viscous: Option<&'n Node>,
}

impl<'n> Tables<'n> {
    const fn of_slot(&self, slot: &str) -> Option<&'n Node> {
        match slot.as_bytes() {
            b"coulomb" => self.coulomb,
            b"hysteresis" => self.hysteresis,
            _ => self.viscous,
        }
    }
}

/// The models of one table, `None` where none is given or it is wrong.
type Models =
    (Option<Box<dyn CoulombModel>>, Option<Box<dyn HysteresisModel>>, Option<Box<dyn ViscousBasis>>);

impl JointDynamics {
    /// The models of every joint, joint after joint.
    ///
    /// # Errors
    /// [`ModelError::SlotRefused`] for a model that does not declare what equation (6) asks of its slot.
    pub fn stacks(&self, joints: usize) -> Result<Vec<JointStack>, Vec<ModelError>> {
        (0..joints)
            .map(|joint| {
                let mut stack = (self.coulomb.clone(), self.hysteresis.clone(), self.viscous.clone());
                for exception in self.overrides.iter().filter(|o| o.joints.contains(&joint)) {
                    stack.0 = exception.coulomb.clone().unwrap_or(stack.0);
                    stack.1 = exception.hysteresis.clone().unwrap_or(stack.1);
                    stack.2 = exception.viscous.clone().unwrap_or(stack.2);
                }
                JointStack::new(stack.0, stack.1, stack.2)
            })
            .collect()
    }

    pub(super) fn read(
        section: Option<Section<'_, '_>>,
        reader: &Reader,
        registry: &Registry,
    ) -> Option<Self> {
        let mut defaults = Tables::default();
        let mut models: Models = (None, None, None);
        let mut overrides = Vec::new();
        let mut override_tables = Vec::new();
        if let Some(mut section) = section {
            (defaults, models) = read_models(&mut section, registry);
            for node in section.tables("override") {
                let Some(below) = Section::new(reader, node, "[[joint_dynamics.override]]") else { continue };
                if let Some((tables, exception)) = JointOverride::read(below, registry) {
                    override_tables.push(tables);
                    overrides.push(exception);
                }
            }
            section.finish();
        }
        complain_about_repetitions(reader, &overrides, &override_tables);
        let given = |table: Option<&Node>| table.is_some();
        let dynamics = Self {
            coulomb: models
                .0
                .or_else(|| default(given(defaults.coulomb), registry, json!({ "model": "constant" })))?,
            hysteresis: models
                .1
                .or_else(|| default(given(defaults.hysteresis), registry, json!({ "model": "sign" })))?,
            viscous: models.2.or_else(|| {
                default(given(defaults.viscous), registry, json!({ "model": "polynomial", "powers": [1] }))
            })?,
            overrides,
        };
        complain_about_refusals(reader, &dynamics, defaults, &override_tables);
        Some(dynamics)
    }
}

impl JointOverride {
    fn read<'n>(mut section: Section<'n, '_>, registry: &Registry) -> Option<(Tables<'n>, Self)> {
        let node = section.require("joints", "joints = [1, 2]");
        let joints = node.and_then(|node| {
            let joints = section.indices_of("joints", node, "joints")?;
            if joints.is_empty() {
                section.complain("joints", node, "names no joint", None);
            }
            for joint in repeated(&joints) {
                section.complain("joints", node, &format!("names joint {joint} twice"), None);
            }
            if let aurt_plugins::NodeKind::Array(items) = &node.kind {
                for (joint, item) in joints.iter().zip(items) {
                    section.reader.check_joints(JointCheck::Joint { joint: *joint, span: item.span.clone() });
                }
            }
            Some(joints)
        });
        let (tables, (coulomb, hysteresis, viscous)) = read_models(&mut section, registry);
        if tables.coulomb.or(tables.hysteresis).or(tables.viscous).is_none() && node.is_some() {
            section.reader.complain(
                Complaint::new(section.span().clone(), "the override changes nothing")
                    .help("give it at least one of `coulomb`, `hysteresis`, `viscous`"),
            );
        }
        section.finish();
        Some((tables, Self { joints: joints?, coulomb, hysteresis, viscous }))
    }
}

fn read_models<'n>(section: &mut Section<'n, '_>, registry: &Registry) -> (Tables<'n>, Models) {
    let tables = Tables {
        coulomb: section.take("coulomb"),
        hysteresis: section.take("hysteresis"),
        viscous: section.take("viscous"),
    };
    let reader = section.reader;
    let models = (
        tables.coulomb.and_then(|node| build(reader, registry, node)),
        tables.hysteresis.and_then(|node| build(reader, registry, node)),
        tables.viscous.and_then(|node| build(reader, registry, node)),
    );
    (tables, models)
}

/// The model of a table; what is wrong with it is reported.
pub(super) fn build<M: SlotModel + ?Sized>(
    reader: &Reader,
    registry: &Registry,
    node: &Node,
) -> Option<Box<M>> {
    let inner = [Slot::Coulomb, Slot::Hysteresis, Slot::Viscous]
        .into_iter()
        .filter_map(|slot| Registry::former_name(slot, node.get(slot.name())?));
    Registry::former_name(M::SLOT, node).into_iter().chain(inner).for_each(|note| reader.note(note));
    registry.build(node).map_err(|errors| errors.into_iter().for_each(|e| reader.complain(e))).ok()
}

/// The model of a slot that is not given; nothing where one is given, but wrong.
fn default<M: SlotModel + ?Sized>(
    given: bool,
    registry: &Registry,
    model: serde_json::Value,
) -> Option<Box<M>> {
    if given { None } else { registry.build_from_json(&model).ok() }
}

/// Two overrides must not both give the same joint's same slot: which one should count?
fn complain_about_repetitions(reader: &Reader, overrides: &[JointOverride], tables: &[Tables<'_>]) {
    for slot in [Slot::Coulomb, Slot::Hysteresis, Slot::Viscous] {
        for (k, later) in tables.iter().enumerate() {
            let Some(node) = later.of_slot(slot.name()) else { continue };
            let earlier = (0..k).filter(|e| tables[*e].of_slot(slot.name()).is_some());
            for joint in
                earlier.flat_map(|e| &overrides[e].joints).filter(|j| overrides[k].joints.contains(j))
            {
                let message =
                    format!("an override above already gives the {} model of joint {joint}", slot.name());
                reader.complain(Complaint::new(node.span.clone(), message));
            }
        }
    }
}

/// Models that lack what equation (6) asks of their slot, each at the table that names it.
fn complain_about_refusals(
    reader: &Reader,
    dynamics: &JointDynamics,
    defaults: Tables<'_>,
    overrides: &[Tables<'_>],
) {
    let everywhere = (dynamics.coulomb.clone(), dynamics.hysteresis.clone(), dynamics.viscous.clone());
    let stacks = dynamics.overrides.iter().zip(overrides).map(|(exception, tables)| {
        let stack = (
            exception.coulomb.clone().unwrap_or_else(|| everywhere.0.clone()),
            exception.hysteresis.clone().unwrap_or_else(|| everywhere.1.clone()),
            exception.viscous.clone().unwrap_or_else(|| everywhere.2.clone()),
        );
        (stack, *tables)
    });
    for ((coulomb, hysteresis, viscous), tables) in
        std::iter::once((everywhere.clone(), defaults)).chain(stacks)
    {
        for refusal in JointStack::new(coulomb, hysteresis, viscous).err().unwrap_or_default() {
            let ModelError::SlotRefused { slot, .. } = &refusal else { continue };
            if let Some(table) = tables.of_slot(slot) {
                let name = table.get("model").unwrap_or(table);
                reader.complain(Complaint::new(name.span.clone(), refusal.to_string()));
            }
        }
    }
}
