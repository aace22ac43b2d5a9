//! What the commands of developers and the programs behind them share: calls of cargo, and the
//! set-up of a machine.

pub mod cargo;
pub mod nightly;
pub mod setup;
