//! The module in process, under a known sky.

use std::collections::BTreeMap;

use raim::sentence;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::sky::Site;
use raim::signal::sky::raw::Simulation;
use raim::verdict::EpochOutput;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};

/// Pause after each burst, in which a receiver would be silent, ms.
const PAUSE_MS: u64 = 600;

/// Largest error of a healthy epoch, m: five sigma of the ionosphere-free noise at the poorest
/// geometry used here.
const HEALTHY_M: f64 = 15.0;

/// Bytes of each epoch of a simulated sky.
pub(crate) struct Sky {
    pub(crate) site: Site,
    pub(crate) lumps: Vec<Vec<u8>>,
}

impl Sky {
    /// Returns GPS and `BeiDou` from `start_s` on, one epoch a second.
    pub(crate) fn from(start_s: f64, epochs: u32) -> Self {
        let simulation = Simulation::above_xian(start_s, epochs, 11);
        let recording = simulation.record();
        let selection = Selection::new("GC", Frequency::Dual).unwrap();
        let mut encoder = Encoder::new(&recording.ephemerides, selection);
        let lumps = recording.epochs.iter().map(|epoch| encoder.epoch(epoch).unwrap()).collect();
        Self { site: simulation.site, lumps }
    }

    /// Returns a sky halfway between two changes of the ephemerides, so that only the first epoch
    /// has any.
    pub(crate) fn quiet(epochs: u32) -> Self {
        Self::from(3600.0, epochs)
    }
}

/// The module, with a copy of its counters.
pub(crate) struct Module {
    pub(crate) receiver: Receiver<MemoryPin>,
    site: Site,
    now_ms: u64,
    noted: BTreeMap<&'static str, u32>,
}

impl Module {
    /// Returns a module without input so far.
    pub(crate) fn new(sky: &Sky) -> Self {
        let boot = Boot::on_host("hostile");
        let receiver = Receiver::new(MemoryPin::default(), boot).unwrap();
        Self { receiver, site: sky.site, now_ms: 0, noted: BTreeMap::new() }
    }

    /// Returns a module that has received the first `epochs` of the sky.
    pub(crate) fn after(sky: &Sky, epochs: usize) -> Self {
        let mut module = Self::new(sky);
        sky.lumps.iter().take(epochs).for_each(|lump| module.recovers(lump));
        module.note();
        module
    }

    /// Stores the counters.
    pub(crate) fn note(&mut self) {
        self.noted = self.receiver.statistics().collect();
    }

    /// Returns the growth of a counter since [`Self::note`].
    pub(crate) fn grown(&self, name: &str) -> u32 {
        let (_, now) = self.receiver.statistics().find(|(counter, _)| *counter == name).expect(name);
        now - self.noted.get(name).copied().unwrap_or(0)
    }

    /// Returns the second of the sky by the module's clock, if both began together.
    pub(crate) fn second(&self) -> usize {
        (self.now_ms / 1000) as usize
    }

    pub(crate) fn pin_is_high(&self) -> bool {
        self.receiver.pin().high
    }

    /// Sends a second's bytes and a pause; returns the output after a check.
    pub(crate) fn receive(&mut self, bytes: &[u8]) -> Vec<EpochOutput> {
        let mut reported = Vec::new();
        self.receiver.gnss(bytes, self.now_ms, &mut reported);
        self.receiver.tick(self.now_ms + PAUSE_MS, &mut reported);
        self.now_ms += 1000;
        self.checked(reported)
    }

    /// Keeps the line silent; returns the output.
    pub(crate) fn silence(&mut self, for_ms: u64) -> Vec<EpochOutput> {
        let mut reported = Vec::new();
        let end_ms = self.now_ms + for_ms;
        for now_ms in (self.now_ms..=end_ms).step_by(100) {
            self.receiver.tick(now_ms, &mut reported);
        }
        self.now_ms = end_ms;
        self.checked(reported)
    }

    /// Checks the invariants of any output.
    fn checked(&self, reported: Vec<u8>) -> Vec<EpochOutput> {
        let text = String::from_utf8(reported).expect("sentences are ASCII");
        let small = text.to_lowercase();
        assert!(!small.contains("nan") && !small.contains("inf"), "a number that is none: {text}");
        let outputs = sentence::epochs(&text).expect("sentences that can be read");
        for output in outputs.iter().filter(|output| output.state.is_protected()) {
            let (error_m, hpl_m) = (self.error_m(output), output.state.hpl_m.expect("a protection level"));
            assert!(error_m <= hpl_m, "misleading: {error_m:.1} m off, HPL {hpl_m} m: {text}");
        }
        if let Some(last) = outputs.last() {
            assert_eq!(self.pin_is_high(), last.state.is_protected(), "the pin against {text}");
        }
        outputs
    }

    /// Returns the horizontal error, m; infinite without a position.
    fn error_m(&self, output: &EpochOutput) -> f64 {
        output.position.map_or(f64::INFINITY, |position| {
            self.site.frame.rotate(position.to_ecef() - self.site.position).horizontal()
        })
    }

    /// Sends a healthy epoch and checks that it is protected, with all satellites, and right.
    pub(crate) fn recovers(&mut self, lump: &[u8]) {
        let reported = self.receive(lump);
        let last = reported.last().expect("an epoch is answered");
        assert!(last.state.is_protected() && last.excluded.is_empty(), "healthy epoch: {last:?}");
        assert!(self.error_m(last) < HEALTHY_M, "healthy epoch: {last:?}");
        assert!(self.pin_is_high());
    }

    /// Sends an unusable epoch and checks that there is no position, and that the pin is low.
    pub(crate) fn has_no_fix(&mut self, lump: &[u8]) {
        let reported = self.receive(lump);
        let [only] = reported.as_slice() else { panic!("one epoch is one answer: {reported:?}") };
        assert_eq!((only.state.state, only.position), ('U', None), "{only:?}");
        assert!(!self.pin_is_high());
    }
}
