use aurt_plugins::{Node, Registry, SlotModel};
use aurt_traits::{CoulombModel, HysteresisModel, JointStack, ModelError, Slot, ViscousBasis};
use serde_json::json;

use super::errors::Complaint;
use super::joint_count::{JointCheck, repeated};
use super::section::{Reader, Section};

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

const SLOTS: [Slot; 3] = [Slot::Coulomb, Slot::Hysteresis, Slot::Viscous];

/// The tables that models of one `[joint_dynamics]` or override were built from, in the order of the slots.
type Tables<'n> = [Option<&'n Node>; 3];

/// The models of one table, `None` where none is given or it is wrong.
type Models =
    (Option<Box<dyn CoulombModel>>, Option<Box<dyn HysteresisModel>>, Option<Box<dyn ViscousBasis>>);

type Stack = (Box<dyn CoulombModel>, Box<dyn HysteresisModel>, Box<dyn ViscousBasis>);

impl JointDynamics {
    pub fn stacks(&self, joints: usize) -> Result<Vec<JointStack>, Vec<ModelError>> {
        (0..joints)
            .map(|joint| {
                let own = self.overrides.iter().filter(|o| o.joints.contains(&joint));
                let stack = own.fold(self.everywhere(), |stack, exception| exception.over(stack));
                JointStack::new(stack.0, stack.1, stack.2)
            })
            .collect()
    }

    fn everywhere(&self) -> Stack {
        (self.coulomb.clone(), self.hysteresis.clone(), self.viscous.clone())
    }

    pub(super) fn read(
        section: Option<Section<'_, '_>>,
        reader: &Reader,
        registry: &Registry,
    ) -> Option<Self> {
        let mut defaults: Tables<'_> = [None; 3];
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
        let (coulomb, hysteresis, viscous) = models;
        let polynomial = json!({ "model": "polynomial", "powers": [1] });
        let dynamics = Self {
            coulomb: coulomb.or_else(|| default(defaults[0], registry, json!({ "model": "constant" })))?,
            hysteresis: hysteresis.or_else(|| default(defaults[1], registry, json!({ "model": "sign" })))?,
            viscous: viscous.or_else(|| default(defaults[2], registry, polynomial))?,
            overrides,
        };
        complain_about_refusals(reader, &dynamics, defaults, &override_tables);
        Some(dynamics)
    }
}

impl JointOverride {
    /// The models of a joint that has the exception.
    fn over(&self, (coulomb, hysteresis, viscous): Stack) -> Stack {
        (
            self.coulomb.clone().unwrap_or(coulomb),
            self.hysteresis.clone().unwrap_or(hysteresis),
            self.viscous.clone().unwrap_or(viscous),
        )
    }

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
        if tables.iter().all(Option::is_none) && node.is_some() {
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
    let tables = SLOTS.map(|slot| section.take(slot.name()));
    let [coulomb, hysteresis, viscous] = tables;
    let reader = section.reader;
    let models = (
        coulomb.and_then(|node| build(reader, registry, node)),
        hysteresis.and_then(|node| build(reader, registry, node)),
        viscous.and_then(|node| build(reader, registry, node)),
    );
    (tables, models)
}

/// The model of a table; what is wrong with it is reported.
pub(super) fn build<M: SlotModel + ?Sized>(
    reader: &Reader,
    registry: &Registry,
    node: &Node,
) -> Option<Box<M>> {
    let inner = SLOTS.into_iter().filter_map(|slot| Registry::former_name(slot, node.get(slot.name())?));
    Registry::former_name(M::SLOT, node).into_iter().chain(inner).for_each(|note| reader.note(note));
    registry.build(node).map_err(|errors| errors.into_iter().for_each(|e| reader.complain(e))).ok()
}

/// The model of a slot that is not given; nothing where one is given, but wrong.
fn default<M: SlotModel + ?Sized>(
    given: Option<&Node>,
    registry: &Registry,
    model: serde_json::Value,
) -> Option<Box<M>> {
    if given.is_some() { None } else { registry.build_from_json(&model).ok() }
}

/// Two overrides must not both give the same joint's same slot: which one should count?
fn complain_about_repetitions(reader: &Reader, overrides: &[JointOverride], tables: &[Tables<'_>]) {
    for (at, slot) in SLOTS.into_iter().enumerate() {
        for (k, later) in tables.iter().enumerate() {
            let Some(node) = later[at] else { continue };
            let earlier = (0..k).filter(|e| tables[*e][at].is_some());
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
    let exceptions = dynamics.overrides.iter().zip(overrides);
    let stacks = exceptions.map(|(exception, tables)| (exception.over(dynamics.everywhere()), *tables));
    for ((coulomb, hysteresis, viscous), tables) in
        std::iter::once((dynamics.everywhere(), defaults)).chain(stacks)
    {
        for refusal in JointStack::new(coulomb, hysteresis, viscous).err().unwrap_or_default() {
            let ModelError::SlotRefused { slot, .. } = &refusal else { continue };
            let at = SLOTS.iter().position(|known| known.name() == *slot);
            if let Some(table) = at.and_then(|at| tables[at]) {
                let name = table.get("model").unwrap_or(table);
                reader.complain(Complaint::new(name.span.clone(), refusal.to_string()));
            }
        }
    }
}
