//! An ordinary receiver beside the module: the same bytes, the same corrections, and every satellite accepted.
//!
//! What it says is what the module's user would have been told without integrity monitoring.

use rai_core::epoch::Epoch;
use rai_core::least_squares::Workspace;
use rai_firmware::config::Systems;
use rai_firmware::correction::{self, CAPACITY, Sky, Tally, locate};
use rai_firmware::ephemeris::Store;
use rai_firmware::input::{Event, Input};
use rai_firmware::raw::RawEpoch;

use crate::sky::Site;

/// What the ordinary receiver makes of an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ordinary {
    /// Seconds since the first epoch.
    pub time_s: f64,
    /// `√(SSE/dof)` of all satellites, dimensionless.
    pub statistic: f64,
    /// Distance from the truth over the ground, m.
    pub horizontal_error_m: f64,
}

/// The receiver.
pub(crate) struct Accepter {
    input: Input,
    store: Store,
    mask_rad: f64,
}

impl Accepter {
    /// A receiver that has heard nothing and uses satellites above `mask_rad`.
    pub(crate) fn new(mask_rad: f64) -> Self {
        Self { input: Input::new(), store: Store::new(), mask_rad }
    }

    /// Takes the bytes of one epoch; `None` where they make no fix with redundancy.
    pub(crate) fn hear(&mut self, bytes: &[u8], time_s: f64, site: &Site) -> Option<Ordinary> {
        let mut said = None;
        let Self { input, store, mask_rad } = self;
        input.feed(bytes, 0, |event| match event {
            Event::Ephemeris(ephemeris) => {
                store.insert(ephemeris, None);
            }
            Event::Epoch(raw, _) => said = judge(raw, store, *mask_rad, time_s, site),
            Event::Position(_) | Event::Ionosphere(..) | Event::Jamming(_) => {}
        });
        said
    }
}

/// One fix of all satellites, corrected for the air above the true site.
fn judge(raw: &RawEpoch, store: &Store, mask_rad: f64, time_s: f64, site: &Site) -> Option<Ordinary> {
    let mut tally = Tally::default();
    let (mut sky, mut epoch) = (Sky::new(), Epoch::new(0.0));
    locate(raw, store, 0.0, Systems::AT_START, &mut tally, &mut sky);
    let air = correction::Site::new(site.position, raw.time, mask_rad, None);
    air.correct(&sky, &mut tally.ranges, &mut epoch);
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
