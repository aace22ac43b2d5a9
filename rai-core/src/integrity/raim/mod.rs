//! Classic RAIM: integrity from the residuals of one solution.
//!
//! | module | question |
//! |---|---|
//! | [`detection`] | Is a range faulty? |
//! | [`isolation`] | Which satellites are faulty? |
//! | [`hypotheses`] | Does another set of satellites, a shifted constellation or a wrong time explain the residuals as well? |
//! | [`levels`] | How large can the position error be while the test passes? |
//! | [`exclusion_levels`] | From which effect on the position is a faulty satellite excluded? |
//! | [`shared_errors`] | How far do errors that all ranges share move the position? |

pub mod detection;
pub mod exclusion_levels;
pub mod hypotheses;
pub mod isolation;
pub mod levels;
pub mod shared_errors;
