//! Batches as their users see them: the same bits as one environment by itself, and failures that
//! stay where they happen. Scenes come from `tangency-bench`.

mod controls;
mod failures;
mod fleet;
mod same_bits;
mod states;
