//! Impulses that a formula names: `impulse(ball, floor).n`, `impulse(hinge).x`.

use tangency::core::measure::Measure;
use tangency::diff::RowImpulse;
use tangency::{Joint, RowSource, Scene, StepRecord};

/// How a name begins that means an impulse.
pub const IMPULSE: &str = "impulse";

/// An impulse of the last step, N·s or N·m·s, over all parts that events divide it into.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Impulse {
    /// The sum over all contacts of two bodies, lower index first.
    Contacts {
        /// The bodies.
        bodies: [usize; 2],
        /// Along the tangent, not the normal.
        tangent: bool,
    },
    /// The sum over these rows of a joint.
    Joint(Vec<RowSource>),
}

impl Impulse {
    /// Reads what follows [`IMPULSE`]: `(ball, floor).n`.
    ///
    /// # Errors
    /// What is wrong, and what is known.
    pub fn parse(text: &str, scene: &Scene) -> Result<Self, String> {
        let expected = "impulses are impulse(BODY, BODY).n, .t, or impulse(JOINT).x and the like";
        let inside = text.trim().strip_prefix('(').and_then(|rest| rest.rsplit_once(')'));
        let (names, component) = inside
            .and_then(|(names, rest)| Some((names, rest.trim().strip_prefix('.')?)))
            .ok_or_else(|| format!("unknown impulse `{IMPULSE}{text}`; {expected}"))?;
        match names.split_once(',') {
            Some((a, b)) => contacts([a.trim(), b.trim()], component, scene),
            None => of_joint(names.trim(), component, scene),
        }
    }

    /// The rows of a step that belong to it, each with its impulse; none where nothing is in reach.
    #[must_use]
    pub fn rows(&self, step: &StepRecord) -> Vec<RowImpulse> {
        let parts = step.parts.iter().enumerate().map(|(part, record)| (Some(part), record));
        let mut rows = Vec::new();
        for (part, record) in parts.chain([(None, step)]) {
            for source in self.sources(record) {
                let value = record.impulse(source);
                rows.extend(value.map(|value| RowImpulse { part, source, value }));
            }
        }
        rows
    }

    fn sources(&self, record: &StepRecord) -> Vec<RowSource> {
        let (bodies, tangent) = match self {
            Self::Contacts { bodies, tangent } => (bodies, *tangent),
            Self::Joint(sources) => return sources.clone(),
        };
        let ids = (0_u32..).zip(&record.contacts);
        let own = ids.filter(|(_, it)| it.feature.id.bodies.map(|b| b as usize) == *bodies);
        let source = |(contact, _)| {
            if tangent { RowSource::Tangent { contact } } else { RowSource::Normal { contact } }
        };
        own.map(source).collect()
    }
}

fn contacts(names: [&str; 2], component: &str, scene: &Scene) -> Result<Impulse, String> {
    let tangent = match component {
        "n" => false,
        "t" => true,
        _ => return Err(format!("contacts have no impulse `.{component}`; take .n or .t")),
    };
    let find = |name: &str| {
        scene.body_index(name).ok_or_else(|| {
            let known: Vec<&str> = scene.bodies().iter().map(|b| b.name.as_str()).collect();
            format!("the scene has no body `{name}`; known: {}", known.join(", "))
        })
    };
    let [a, b] = [find(names[0])?, find(names[1])?];
    if !scene.collides(a, b) {
        return Err(format!("`{}` and `{}` do not collide", names[0], names[1]));
    }
    Ok(Impulse::Contacts { bodies: [a.min(b), a.max(b)], tangent })
}

fn of_joint(name: &str, component: &str, scene: &Scene) -> Result<Impulse, String> {
    let index = scene.joint_index(name).ok_or_else(|| {
        let known: Vec<&str> = scene.joints().iter().map(|j| j.name.as_str()).collect();
        format!("the scene has no joint `{name}`; known: {}", known.join(", "))
    })?;
    let rows = rows_of(&scene.joints()[index], u32::try_from(index).expect("joints are few"));
    let of_it = |(known, row): &(&str, RowSource)| (*known == component).then_some(*row);
    let found: Vec<RowSource> = rows.iter().filter_map(of_it).collect();
    if found.is_empty() {
        let known: Vec<String> = rows.iter().map(|(known, _)| format!(".{known}")).collect();
        let known = known.join(", ");
        return Err(format!("joint `{name}` has no impulse `.{component}`; it has {known}"));
    }
    Ok(Impulse::Joint(found))
}

/// The rows that a joint can have, by name.
fn rows_of(it: &Joint, joint: u32) -> Vec<(&'static str, RowSource)> {
    let held = (0_u32..).zip(&it.held).map(|(row, held)| {
        let name = match held.measure {
            Measure::World { axis } if axis.x == 1.0 => "x",
            Measure::World { .. } => "y",
            Measure::OnA { .. } => "across",
            Measure::Length => "length",
            Measure::Angle => "angle",
        };
        (name, RowSource::Held { joint, row })
    });
    let mut rows: Vec<(&'static str, RowSource)> = held.collect();
    rows.extend(it.motor.is_some().then_some(("motor", RowSource::Motor { joint })));
    rows.extend(it.limits.lower.is_some().then_some(("lower", RowSource::Lower { joint })));
    rows.extend(it.limits.upper.is_some().then_some(("upper", RowSource::Upper { joint })));
    rows
}
