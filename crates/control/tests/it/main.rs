//! The planner on systems whose best controls are known, and what it refuses.

mod box_qp;
mod linear;
mod refusals;
mod regulator;
mod scene;
mod searching;
mod swing;
