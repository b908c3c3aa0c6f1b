//! `<default>`: attributes that elements of a class have unless they say otherwise.

use std::collections::HashMap;

use roxmltree::Node;

type Attributes<'x> = HashMap<&'x str, &'x str>;

/// The defaults that one class states, and the class around it, whose defaults it has as well.
#[derive(Debug, Default)]
struct Class<'x> {
    around: Option<usize>,
    joint: Attributes<'x>,
    geom: Attributes<'x>,
    actuator: Attributes<'x>,
    /// Whether it turns geoms, which overrules how the class around it does.
    is_turned: bool,
    /// `size` of a geom: a class may change the first of its numbers alone.
    size: [Option<&'x str>; 3],
}

/// All classes, and the place of each by its name.
#[derive(Debug, Default)]
pub(super) struct Classes<'x> {
    all: Vec<Class<'x>>,
    named: HashMap<&'x str, usize>,
}

/// The class of elements that name none.
const MAIN: &str = "main";
const ACTUATORS: [&str; 10] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
];
/// Orientations: one of them overrules all that stand further out.
const TURNS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

impl<'x> Classes<'x> {
    /// Reads the `<default>` sections of a file; a class inherits those that it lies in.
    pub fn read(root: Node<'x, 'x>) -> Self {
        let mut classes = Self::default();
        let sections = |node: Node<'x, 'x>| node.children().filter(|c| c.has_tag_name("default"));
        for section in sections(root) {
            let mut open = vec![(section, classes.named.get(MAIN).copied())];
            while let Some((node, around)) = open.pop() {
                let size = around.map_or([None; 3], |around| classes.all[around].size);
                let mut class = Class { around, size, ..Class::default() };
                for child in node.children().filter(Node::is_element) {
                    let attributes = match child.tag_name().name() {
                        "joint" => &mut class.joint,
                        "geom" => &mut class.geom,
                        name if ACTUATORS.contains(&name) => &mut class.actuator,
                        _ => continue,
                    };
                    if child.has_tag_name("geom") {
                        overlay(&mut class.size, child);
                        if is_turned(child) {
                            attributes.retain(|name, _| !TURNS.contains(name));
                            class.is_turned = true;
                        }
                    }
                    attributes.extend(child.attributes().map(|a| (a.name(), a.value())));
                }
                let place = classes.all.len();
                classes.all.push(class);
                classes.named.insert(node.attribute("class").unwrap_or(MAIN), place);
                open.extend(sections(node).map(|section| (section, Some(place))));
            }
        }
        classes
    }

    /// An attribute of a joint, geom or actuator: its own, else that of its class, else that of the class around it.
    pub fn attribute(&self, node: Node<'x, 'x>, around: Option<&str>, name: &str) -> Option<&'x str> {
        if let Some(own) = node.attribute(name) {
            return Some(own);
        }
        let mut next = self.of(node, around);
        while let Some(class) = next {
            let (attributes, ends) = match node.tag_name().name() {
                "geom" => (&class.geom, class.is_turned && TURNS.contains(&name)),
                name if ACTUATORS.contains(&name) => (&class.actuator, false),
                _ => (&class.joint, false),
            };
            if let Some(value) = attributes.get(name) {
                return Some(value);
            }
            next = class.around.filter(|_| !ends).map(|around| &self.all[around]);
        }
        None
    }

    /// The numbers of `size` of a geom: its own, and behind these the rest of its class.
    pub fn size(&self, node: Node<'x, 'x>, around: Option<&str>) -> [Option<&'x str>; 3] {
        let mut size = self.of(node, around).map_or([None; 3], |class| class.size);
        overlay(&mut size, node);
        size
    }

    /// As [`Self::attribute`], of the attributes that place a geom.
    pub fn placing(&self, node: Node<'x, 'x>, around: Option<&str>, name: &str) -> Option<&'x str> {
        let own = TURNS.contains(&name) && is_turned(node);
        if own { node.attribute(name) } else { self.attribute(node, around, name) }
    }

    fn of(&self, node: Node<'x, 'x>, around: Option<&str>) -> Option<&Class<'x>> {
        self.named.get(node.attribute("class").or(around).unwrap_or(MAIN)).map(|place| &self.all[*place])
    }

    /// The class that an element names but that no `<default>` defines.
    pub fn unknown(&self, node: Node<'x, 'x>) -> Option<&'x str> {
        let named = ["class", "childclass"].into_iter().filter_map(|key| node.attribute(key));
        named.filter(|name| *name != MAIN).find(|name| !self.named.contains_key(name))
    }
}

fn is_turned(geom: Node<'_, '_>) -> bool {
    TURNS.iter().any(|turn| geom.has_attribute(*turn))
}

fn overlay<'x>(size: &mut [Option<&'x str>; 3], geom: Node<'x, 'x>) {
    let own = geom.attribute("size").unwrap_or_default().split_whitespace();
    size.iter_mut().zip(own).for_each(|(size, own)| *size = Some(own));
}
