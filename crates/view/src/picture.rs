//! A picture of a scene at a state.

use std::collections::BTreeMap;

use tangency_core::{Scene, State};

use crate::canvas::Canvas;
use crate::draw_body::draw_body;
use crate::draw_joint::draw_joint;
use crate::image::Image;
use crate::joint_look::JointLook;
use crate::look::BodyLook;
use crate::palette::{HUES, Inks, Rgb};
use crate::{View, ViewError};

/// How pictures of a scene are drawn.
///
/// ```
/// use tangency_core::{BodyDef, Scene, SceneDef, Shape};
/// use tangency_view::{Picture, Style, View};
///
/// let disc = Shape::Circle { radius: 1.0, center: [0.0, 0.0] };
/// let ball = BodyDef { name: "ball".into(), shapes: vec![disc], ..BodyDef::default() };
/// let scene = Scene::new(&SceneDef { bodies: vec![ball], ..SceneDef::default() })?;
/// let view = View { lower: [-2.0, -1.0], upper: [2.0, 1.0] };
/// let picture = Picture { width: 400, height: 200, view, style: Style::default() };
///
/// let rgb = picture.draw(&scene, &scene.initial_state())?.to_rgb();
/// assert_eq!(rgb.len(), 3 * 400 * 200);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels from left to right, 1 to 8000.
    pub width: u32,
    /// Pixels from top to bottom, 1 to 8000.
    pub height: u32,
    /// What part of the world it holds: all of it, in the middle.
    pub view: View,
    /// Colours, and what is shown.
    pub style: Style,
}

/// What a picture looks like.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Style {
    /// Colour where nothing is; the default is white.
    pub background: Rgb,
    /// Whether joints are shown; they are by default.
    pub joints: bool,
    /// Colours of bodies by their index in the scene. All others have the colours of the replay page: one
    /// per group or, outside of groups, per body, and grey for what nothing can push.
    pub colors: BTreeMap<usize, Rgb>,
}

impl Default for Style {
    fn default() -> Self {
        Self { background: [255; 3], joints: true, colors: BTreeMap::new() }
    }
}

impl Picture {
    /// The scene at a state: fixed bodies behind, the others in the scene's order, joints in front.
    ///
    /// The same input gives the same bytes.
    ///
    /// # Errors
    /// [`ViewError`], if the size, the view, a colour or the state is not one.
    pub fn draw(&self, scene: &Scene, state: &State) -> Result<Image, ViewError> {
        let bodies = scene.bodies().len();
        state.check(bodies)?;
        if let Some((&body, _)) = self.style.colors.range(bodies..).next() {
            return Err(ViewError::Body { body, bodies });
        }
        let size = [self.width, self.height];
        let mut canvas = Canvas::new(size, &self.view, self.style.background)?;
        self.draw_bodies(&mut canvas, scene, state);
        if self.style.joints {
            self.draw_joints(&mut canvas, scene, state);
        }
        Ok(Image::new(canvas.finish()))
    }

    fn draw_bodies(&self, canvas: &mut Canvas, scene: &Scene, state: &State) {
        let looks = BodyLook::all(scene);
        for fixed in [true, false] {
            for (body, look) in looks.iter().enumerate().filter(|(_, look)| look.fixed == fixed) {
                draw_body(canvas, look, &state.q[body], self.color(body, look));
            }
        }
    }

    fn color(&self, body: usize, look: &BodyLook) -> Rgb {
        let usual = || {
            if look.fixed { self.inks().fixed } else { HUES[look.hue % HUES.len()] }
        };
        self.style.colors.get(&body).copied().unwrap_or_else(usual)
    }

    fn draw_joints(&self, canvas: &mut Canvas, scene: &Scene, state: &State) {
        for joint in &JointLook::all(scene) {
            draw_joint(canvas, joint, &state.q, &self.inks(), self.style.background);
        }
    }

    fn inks(&self) -> Inks {
        Inks::on(self.style.background)
    }
}
