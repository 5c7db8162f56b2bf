//! How joints look, whoever draws them.

use serde::Serialize;
use tangency_core::measure::Measure;
use tangency_core::{Joint, JointDef, JointKind, Scene};

/// How a joint looks.
#[derive(Clone, Debug)]
pub(crate) struct JointLook {
    pub(crate) kind: Link,
    /// Bodies a and b; `None` is the world.
    pub(crate) bodies: [Option<usize>; 2],
    /// Anchors in the bodies' frames, m.
    pub(crate) ends: [[f64; 2]; 2],
    /// Where b may travel.
    pub(crate) rail: Option<Rail>,
}

/// What is drawn between the two ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Link {
    Pin,
    Weld,
    Rod,
    Spring,
}

/// A line through a's end that b's end may travel along.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rail {
    /// Direction in a's frame.
    pub(crate) axis: [f64; 2],
    /// From, m; without end if absent.
    pub(crate) lower: Option<f64>,
    /// To, m.
    pub(crate) upper: Option<f64>,
}

impl JointLook {
    /// The looks of all joints that are drawn: locks are not.
    pub(crate) fn all(scene: &Scene) -> Vec<Self> {
        let joints = scene.joints().iter().zip(&scene.def().joints);
        joints.filter_map(|(joint, def)| Self::new(joint, def)).collect()
    }

    fn new(joint: &Joint, def: &JointDef) -> Option<Self> {
        let kind = match def.kind {
            JointKind::Revolute { .. } | JointKind::Prismatic { .. } | JointKind::Slot { .. } => {
                Link::Pin
            }
            JointKind::Weld { .. } => Link::Weld,
            JointKind::Distance { .. } => Link::Rod,
            JointKind::Spring { .. } => Link::Spring,
            JointKind::Lock { .. } => return None,
        };
        let (bodies, ends) = (joint.bodies, joint.anchors.map(Into::into));
        Some(Self { kind, bodies, ends, rail: rail(joint) })
    }
}

fn rail(joint: &Joint) -> Option<Rail> {
    let axis = match joint.free?.measure {
        Measure::World { axis } | Measure::OnA { axis_local: axis } => axis.into(),
        Measure::Length | Measure::Angle => return None,
    };
    Some(Rail { axis, lower: joint.limits.lower, upper: joint.limits.upper })
}
