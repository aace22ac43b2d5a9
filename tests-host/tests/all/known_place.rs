//! A known place, a known height and a receiver's report on itself, from bytes to the pin and to
//! the sentences that report them.

use raim::sentence;
use raim::signal::encode::{Encoder, Frequency, Selection, ubx};
use raim::signal::sky::raw::Simulation;
use raim_core::frame::Geodetic;
use raim_core::satellite::Constellation;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};

/// A module on a line that brings one epoch a second.
struct Module {
    receiver: Receiver<MemoryPin>,
    now_ms: u64,
}

impl Module {
    fn new() -> Self {
        let receiver = Receiver::new(MemoryPin::default(), Boot::on_host("known place"));
        Self { receiver: receiver.expect("the module starts"), now_ms: 0 }
    }

    /// Sends bytes to the GNSS port and returns what the module says within a second.
    fn receive(&mut self, bytes: &[u8]) -> String {
        let mut reported = Vec::new();
        self.receiver.gnss(bytes, self.now_ms, &mut reported);
        self.receiver.tick(self.now_ms + 600, &mut reported);
        self.now_ms += 1000;
        String::from_utf8(reported).expect("sentences are ASCII")
    }

    fn obey(&mut self, text: &str) -> String {
        let mut reported = Vec::new();
        // A command is as old as the last time that the module was told.
        self.receiver.tick(self.now_ms, &mut reported);
        self.receiver.command(sentence::command(text).as_bytes(), &mut reported);
        self.receiver.tick(self.now_ms, &mut reported);
        String::from_utf8(reported).expect("sentences are ASCII")
    }

    fn is_promised(&self) -> bool {
        self.receiver.pin().high
    }

    fn counter(&self, name: &str) -> u32 {
        let mut counters = self.receiver.statistics();
        counters.find_map(|(counter, count)| (counter == name).then_some(count)).expect("a counter")
    }
}

/// Returns the epochs of a quiet sky as bytes, with so many GPS satellites, every second one, or
/// with all, and where the antenna is.
fn sky(epochs: u32, satellites: Option<usize>) -> (Vec<Vec<u8>>, Geodetic) {
    let simulation = Simulation::above_xian(3600.0, epochs, 1);
    let mut recording = simulation.record();
    if let Some(count) = satellites {
        let first = &recording.epochs[0].satellites;
        let of_gps =
            first.iter().map(|raw| raw.satellite).filter(|id| id.constellation() == Constellation::Gps);
        let kept: Vec<_> = of_gps.step_by(2).take(count).collect();
        for epoch in &mut recording.epochs {
            epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
        }
    }
    let selection = Selection::new("GC", Frequency::Dual).expect("a selection");
    let mut encoder = Encoder::new(&recording.ephemerides, selection);
    let bytes = recording.epochs.iter().map(|epoch| encoder.epoch(epoch).expect("an epoch"));
    (bytes.collect(), simulation.site.frame.geodetic())
}

/// Returns the fields of the first sentence with this address, without its checksum.
fn fields<'s>(reported: &'s str, address: &str) -> Option<Vec<&'s str>> {
    let start = format!("${address},");
    let line = reported.lines().find_map(|line| line.strip_prefix(&start))?;
    Some(line.split('*').next().unwrap_or(line).split(',').collect())
}

/// Returns state and reason of the epoch.
fn verdict(reported: &str) -> (&str, &str) {
    let fields = fields(reported, "PRAIS").expect("an epoch");
    (fields[1], fields[2])
}

/// Returns the fields of all sentences of the settings in force.
fn settings(reported: &str) -> Vec<String> {
    let lines = reported.lines().filter(|line| line.starts_with("$PRAIQ,"));
    lines.flat_map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>()).collect()
}

fn place(at: &Geodetic, north_deg: f64) -> String {
    let [latitude_deg, longitude_deg] = [at.latitude_rad, at.longitude_rad].map(f64::to_degrees);
    format!("PLACE,{:.6},{longitude_deg:.6},{:.1},1", latitude_deg + north_deg, at.height_m)
}

#[test]
fn another_place_takes_the_promise_back_and_off_returns_it() {
    let (epochs, at) = sky(40, None);
    let mut module = Module::new();
    for bytes in &epochs[..20] {
        module.receive(bytes);
    }
    assert!(module.is_promised());
    // 0.02 degrees of latitude are 2.2 km.
    let reported = module.obey(&place(&at, 0.02));
    assert!(!module.is_promised(), "a promise under other settings stands: {reported}");
    assert!(settings(&reported).iter().any(|field| field.starts_with("34.19")), "{reported}");
    for bytes in &epochs[20..30] {
        let reported = module.receive(bytes);
        assert_eq!(verdict(&reported), ("U", "PLACE"));
        assert!(!module.is_promised());
    }
    let reported = module.obey("PLACE,OFF");
    assert!(settings(&reported).iter().any(|field| field == "OFF"), "{reported}");
    let reported = module.receive(&epochs[30]);
    assert_eq!((verdict(&reported), module.is_promised()), (("P", "OK"), true));
    assert_eq!(fields(&reported, "PRAIH"), None);
}

#[test]
fn own_place_keeps_the_promise_and_its_height_is_reported() {
    let (epochs, at) = sky(30, None);
    let mut module = Module::new();
    module.obey(&place(&at, 0.0));
    for (index, bytes) in epochs.iter().enumerate() {
        let reported = module.receive(bytes);
        let height = fields(&reported, "PRAIH").expect("a known height");
        let difference_m: f64 = height[2].parse().expect("a difference");
        // Five sigma of the height above Xi'an, as in the test of the site.
        assert!(height[1] == "U" && difference_m.abs() < 7.0, "{reported}");
        assert_eq!((verdict(&reported), module.is_promised()), (("P", "OK"), true), "epoch {index}");
    }
}

/// The host states a height for ten seconds: four satellites can be tested while it holds, and not
/// one second longer.
#[test]
fn expired_height_ends_the_promise_that_needs_it_and_a_new_one_returns_it() {
    let (epochs, at) = sky(60, Some(4));
    let mut module = Module::new();
    let state = format!("HEIGHTAID,{:.1},3", at.height_m);
    for (index, bytes) in epochs.iter().enumerate() {
        if (20..=35).contains(&index) || index >= 50 {
            module.obey(&state);
        }
        let reported = module.receive(bytes);
        let height = fields(&reported, "PRAIH").map(|height| height[1].to_owned());
        // The last of the first heights came with epoch 35 and holds for ten seconds.
        if (20..=45).contains(&index) || index >= 50 {
            assert_eq!(height.as_deref(), Some("N"), "epoch {index}: {reported}");
            // A first promise with one degree of freedom needs ten seconds of agreement.
            assert_eq!(module.is_promised(), index >= 30, "epoch {index}: {reported}");
        } else {
            assert_eq!(height, None, "epoch {index}: {reported}");
            assert_eq!(verdict(&reported), ("U", "REDUNDANCY"), "epoch {index}");
            assert!(!module.is_promised());
        }
    }
    assert_eq!(module.counter("heights_expired"), 1);
}

/// A height that never agreed is left out and reported, and costs no promise.
#[test]
fn wrong_height_is_left_out_and_reported() {
    let (epochs, at) = sky(20, None);
    let mut module = Module::new();
    for bytes in &epochs {
        module.obey(&format!("HEIGHTAID,{:.1},3", at.height_m + 200.0));
        let reported = module.receive(bytes);
        let height = fields(&reported, "PRAIH").expect("a known height");
        let difference_m: f64 = height[2].parse().expect("a difference");
        assert!(height[1] == "X" && (difference_m - 200.0).abs() < 7.0, "{reported}");
        assert!(module.is_promised());
    }
}

/// The receiver's own levels and authenticated signals stand beside the verdict until the receiver
/// is silent about them for three seconds.
#[test]
fn receivers_own_levels_and_signals_are_reported_until_it_is_silent() {
    let (epochs, _) = sky(10, None);
    // NAV-SIG: 90 signals, bit 9 of their flags in two. NAV-PL: 12e-8 an hour, valid, along the
    // axes north, east, down 1.5, 2.25 and 4 m.
    let mut signals = [0_u8; 8 + 90 * 16];
    signals[5] = 90;
    (signals[8 + 11], signals[40 + 11]) = (2, 2);
    let mut levels = [0_u8; 52];
    (levels[0], levels[1], levels[2], levels[3]) = (1, 12, 0_u8.wrapping_sub(8), 1);
    for (index, level_mm) in [1500_u32, 2250, 4000].into_iter().enumerate() {
        levels[16 + 4 * index..20 + 4 * index].copy_from_slice(&level_mm.to_le_bytes());
    }
    let own = [ubx::frame([0x01, 0x43], &signals), ubx::frame([0x01, 0x62], &levels)].concat();
    let mut module = Module::new();
    for (index, bytes) in epochs.iter().enumerate() {
        let own = if index < 5 { &own[..] } else { &[] };
        let reported = module.receive(&[own, bytes].concat());
        let evidence = fields(&reported, "PRAIE").map(|fields| fields[1..].join(","));
        if index < 5 {
            assert_eq!(evidence.as_deref(), Some("2,0,1.500,2.250,4.000,12,-8"), "epoch {index}: {reported}");
        } else if index > 8 {
            assert_eq!(evidence, None, "epoch {index}: {reported}");
        }
        assert!(module.is_promised(), "epoch {index}: {reported}");
    }
}

/// SEC-SIG 2: jamming watched for and critical, spoofing watched for and none.
#[test]
fn jamming_alone_is_reported_and_costs_no_promise() {
    let (epochs, _) = sky(10, None);
    let critical = ubx::frame([0x27, 0x09], &[2, 0b0001_1111, 0, 0]);
    let mut module = Module::new();
    for bytes in &epochs {
        let reported = module.receive(&[&critical[..], bytes].concat());
        let end = fields(&reported, "PRAIN").expect("the end of an epoch");
        assert_eq!(end[3..], ["3", "1"], "{reported}");
        assert!(module.is_promised(), "{reported}");
    }
}
