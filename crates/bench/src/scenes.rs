//! Scenes with names: those of the validation cases (`V05` and so on), the paper's chain, and
//! small machines that use every feature of the engine.
//!
//! All are plain definitions; whoever uses one may change its fields before building it.

mod billiard;
mod bodies;
mod bounce;
mod bullet;
mod conflict;
mod contacts;
mod crank;
mod hollow;
mod joints;
mod ladder;
mod landing;
mod linkage;
mod machines;
mod masonry;
mod race;
mod rocker;
mod suspension;
mod tasks;
mod throw;
mod tight;

pub use billiard::billiard;
pub use bodies::{
    block, copies, disc, fixed_block, floor, hinge, material, plane, rod, slender_inertia,
    unit_scene,
};
pub use bounce::{bank_shot, between_discs, pursuit, pushed_pair, thrown_down};
pub use bullet::{bullet, spin_up};
pub use conflict::{coincident_discs, overlapping_boxes, overstretched_rod, press};
pub use contacts::{
    cradle, falling_disc, free_flight, head_on, incline_block, incline_disc, line_collision,
    oblique_collision, redundant_floor, rod_hit, sliding_box, sliding_disc, spinning_disc, stack,
    tipping_box,
};
pub use crank::{clamped_rod, level_pair, slider_crank, supported_rod};
pub use hollow::{groove, shallow_hollow};
pub use joints::{chain, doubled_hinge, hanging_chain_hit, paper_chain, pendulum};
pub use ladder::ladder;
pub use landing::{corner_landing, falling_discs, grazing_disc, unit_slider};
pub use linkage::{double_pendulum, parallelogram};
pub use machines::{
    bent_arm, compound_tumble, conveyor, motor_arm, piston, soft_bridge, spring_cart,
};
pub use masonry::{arch, gable, pyramid};
pub use race::{race_bounce, race_cartpole, race_chain, race_scenes, race_stack};
pub use rocker::{curb, rocking_box, spool};
pub use suspension::{suspended_chain, turned_chain};
pub use tasks::{driven_pendulum, hanging_cartpole, pushed_box};
pub use throw::{basket, hidden_plate};
pub use tight::{misfit_hinges, narrow_slot, seesaw, wedged_box};
