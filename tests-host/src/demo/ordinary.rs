//! An ordinary receiver beside the module: the same bytes, the same corrections, and all satellites believed.
//!
//! What it says is what the module's user would have been told without integrity monitoring.

use rai_core::fix::Workspace;
use rai_firmware::correction::{self, CAPACITY, Tally, locate};
use rai_firmware::ephemeris::Store;
use rai_firmware::rtcm::{Decoder, Event, RawEpoch};

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
pub(crate) struct Believer {
    decoder: Decoder,
    store: Store,
    mask_rad: f64,
}

impl Believer {
    /// A receiver that has heard nothing and uses satellites above `mask_rad`.
    pub(crate) fn new(mask_rad: f64) -> Self {
        Self { decoder: Decoder::new(), store: Store::new(), mask_rad }
    }

    /// Takes the bytes of one epoch; `None` where they make no fix with redundancy.
    pub(crate) fn hear(&mut self, bytes: &[u8], time_s: f64, site: &Site) -> Option<Ordinary> {
        let mut said = None;
        for &byte in bytes {
            let mut event = self.decoder.push(byte);
            while let Some(found) = event {
                match found {
                    Event::Ephemeris(ephemeris) => {
                        self.store.insert(ephemeris, None);
                    }
                    Event::Epoch(raw) => {
                        said = judge(raw, &self.store, self.mask_rad, time_s, site);
                    }
                    Event::ReferencePosition(_) => {}
                }
                event = self.decoder.pending();
            }
        }
        said
    }
}

/// One fix of all satellites, corrected for the air above the true site.
fn judge(raw: &RawEpoch, store: &Store, mask_rad: f64, time_s: f64, site: &Site) -> Option<Ordinary> {
    let mut tally = Tally::default();
    let sky = locate(raw, store, &mut tally);
    let air = correction::Site::new(site.position, raw.time, mask_rad, None);
    let epoch = air.correct(&sky, &mut tally.ranges);
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
