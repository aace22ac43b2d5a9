//! An ordinary receiver beside the module: the same bytes, the same corrections, and every
//! satellite accepted.
//!
//! Its positions are those that the user would receive without integrity monitoring.

use raim::signal::sky::Site;
use raim_core::epoch::Epoch;
use raim_core::internals::least_squares::Workspace;
use raim_firmware::correction::{self, CAPACITY, Sky, Tally, locate};
use raim_firmware::ephemeris::Store;
use raim_firmware::input::{Event, Input};
use raim_firmware::raw::RawEpoch;
use raim_firmware::settings::Systems;

/// Result of the ordinary receiver for an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ordinary {
    /// Time since the first epoch, s.
    pub time_s: f64,
    /// `√(SSE/dof)` of all satellites, dimensionless.
    pub statistic: f64,
    /// Horizontal distance from the truth, m.
    pub horizontal_error_m: f64,
}

/// The ordinary receiver.
pub struct Accepter {
    input: Input,
    store: Store,
    mask_rad: f64,
}

impl Accepter {
    /// Returns a receiver without input so far that uses satellites above `mask_rad`.
    pub fn new(mask_rad: f64) -> Self {
        Self { input: Input::new(), store: Store::new(), mask_rad }
    }

    /// Processes the bytes of one epoch; returns `None` if they give no fix with redundancy.
    pub fn receive(&mut self, bytes: &[u8], time_s: f64, site: &Site) -> Option<Ordinary> {
        let mut reported = None;
        let Self { input, store, mask_rad } = self;
        input.feed(bytes, 0, |event| match event {
            Event::Ephemeris(ephemeris) => {
                store.insert(ephemeris, None);
            }
            Event::Epoch(raw, _) => reported = judge(raw, store, *mask_rad, time_s, site),
            Event::Redated(present) => store.redate(present),
            _ => {}
        });
        reported
    }
}

/// Computes one fix of all satellites, corrected for the atmosphere above the true site.
fn judge(raw: &RawEpoch, store: &Store, mask_rad: f64, time_s: f64, site: &Site) -> Option<Ordinary> {
    let mut tally = Tally::default();
    let (mut sky, mut epoch) = (Sky::new(), Epoch::new(0.0));
    locate(raw, store, 0.0, Systems::AT_START, &mut tally, &mut sky);
    let air = correction::Site::new(site.position, raw.time, mask_rad, None);
    air.correct(&sky, &mut tally, &mut epoch);
    let mut workspace = Workspace::<f64, CAPACITY>::new();
    let fix = workspace.fix(&epoch, site.position).ok()?;
    let snapshot = fix.snapshot();
    let dof = snapshot.dof();
    (dof > 0).then(|| Ordinary {
        time_s,
        statistic: (snapshot.sse() / dof as f64).sqrt(),
        horizontal_error_m: site.frame.rotate(fix.position() - site.position).horizontal(),
    })
}
