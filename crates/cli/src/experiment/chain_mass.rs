//! stub
use clap::Args;
use crate::{Console, Failure};
/// x
#[derive(Args, Debug)]
pub struct Arguments {}
/// x
pub(super) fn run(_: &Arguments, _: &Console) -> Result<(), Failure> { Ok(()) }
