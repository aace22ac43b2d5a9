//! A session run twice: as calls for the C program, and in Rust, whose results are laid out by the
//! header.

use raim::sentence;
use raim_core::epoch::{Epoch, Observation};
use raim_core::internals::continuity::ContinuitySettings;
use raim_core::internals::integrity::Method;
use raim_core::internals::integrity::raim::detection::threshold::policy::Policy;
use raim_core::internals::integrity::raim::isolation::parity::Isolation;
use raim_core::internals::velocity::Velocity;
use raim_core::monitor::Strategy;
use raim_core::report::{Report, Verdict};
use raim_core::requirements::Requirements;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_single::{CAPACITY, Monitor};
use rig::capi::{self, calls::Calls};

/// Calls, and the wanted result of each.
pub(crate) struct Session {
    calls: Calls,
    want: Vec<Vec<u8>>,
    header: String,
    monitor: Option<Monitor>,
    receiver: Option<Receiver<MemoryPin>>,
    protected: usize,
}

impl Session {
    pub(crate) fn new() -> Self {
        let header = std::fs::read_to_string(capi::header_path()).expect("the header is committed");
        Self {
            calls: Calls::default(),
            want: Vec::new(),
            header,
            monitor: None,
            receiver: None,
            protected: 0,
        }
    }

    pub(crate) fn calls(&self) -> &Calls {
        &self.calls
    }

    pub(crate) fn want(&self) -> &[Vec<u8>] {
        &self.want
    }

    /// Returns the number of the receiver's epochs after which the pin was high.
    pub(crate) fn protected(&self) -> usize {
        self.protected
    }

    /// Returns a constant of the header.
    fn constant(&self, name: &str) -> u8 {
        let line = self.header.lines().find_map(|line| line.strip_prefix(&format!("#define {name} ")));
        line.and_then(|value| value.parse().ok()).unwrap_or_else(|| panic!("the header has no {name}"))
    }

    pub(crate) fn prepare(&mut self, [phase, method, policy, clock_aid]: [u8; 4]) {
        self.calls.prepare([phase, method, policy, clock_aid]);
        let requirements = match phase {
            0 => Requirements::en_route(),
            1 => Requirements::terminal(),
            2 => Requirements::non_precision_approach(),
            _ => Requirements::lpv200(),
        };
        // The C interface uses the time to alert and the guard fraction of non-precision approach
        // in any phase.
        let base = Requirements::non_precision_approach();
        let asked = requirements.with_time_to_alert_s(base.time_to_alert_s);
        let mut monitor = Monitor::new(asked).expect("in the tables");
        monitor
            .set_strategy(
                Strategy::DEFAULT
                    .with_policy([Policy::T1, Policy::T2, Policy::TOp][usize::from(policy)])
                    .with_method(
                        [
                            Method::Auto,
                            Method::Baarda,
                            Method::Parity(Isolation::Simultaneous),
                            Method::Parity(Isolation::Sequential),
                            Method::Parity(Isolation::Hybrid),
                            Method::Parity(Isolation::Grouping),
                            Method::Ransac,
                            Method::Araim,
                        ][usize::from(method)],
                    )
                    .with_clock_aid(clock_aid != 0),
            )
            .expect("every method is built in");
        self.monitor = Some(monitor);
        let continuity = ContinuitySettings::anywhere();
        let mut settings = 80_u32.to_le_bytes().to_vec();
        settings.extend([policy, method, clock_aid, self.constant("RAI_LEVELS_BOUND")]);
        settings.extend(doubles([
            requirements.hal_m,
            requirements.val_m.unwrap_or(0.0),
            requirements.false_alarm.get(),
            requirements.missed_detection.get(),
            continuity.max_speed_m_s,
            continuity.min_height_m,
            continuity.max_height_m,
            continuity.recovery.seconds,
        ]));
        settings.extend(continuity.recovery.epochs.to_le_bytes());
        settings.extend([0; 6]);
        self.want.push(settings);
    }

    pub(crate) fn judge(&mut self, epoch: &Epoch<CAPACITY>) {
        self.calls.judge(epoch);
        let report = raim_single::process(self.monitor.as_mut().expect("prepared"), epoch);
        self.want.push(self.of_report(&report));
    }

    pub(crate) fn forget(&mut self) {
        self.calls.forget();
        self.monitor.as_mut().expect("prepared").forget_position();
        self.want.push(Vec::new());
    }

    /// Judges an epoch, and asks for its accuracy and residuals.
    pub(crate) fn judge_and_explain(&mut self, epoch: &Epoch<CAPACITY>) {
        self.calls.judge(epoch);
        let report = raim_single::process(self.monitor.as_mut().expect("prepared"), epoch);
        self.want.push(self.of_report(&report));
        self.calls.explain();
        let mut want = accuracy(Some(&report));
        want.extend(residuals(epoch, &report));
        self.want.push(want);
    }

    pub(crate) fn start(&mut self) {
        self.calls.start();
        let boot = Boot::on_host("library");
        let receiver =
            self.receiver.insert(Receiver::new(MemoryPin::default(), boot).expect("in the tables"));
        let mut reported = Vec::new();
        receiver.greet(&mut reported);
        self.want.push(reported);
    }

    pub(crate) fn gnss(&mut self, now_ms: u64, bytes: &[u8]) {
        self.calls.gnss(now_ms, bytes);
        self.receive(|receiver, reported| receiver.gnss(bytes, now_ms, reported));
    }

    pub(crate) fn tick(&mut self, now_ms: u64) {
        self.calls.tick(now_ms);
        self.receive(|receiver, reported| {
            receiver.tick(now_ms, reported);
            false
        });
    }

    pub(crate) fn command(&mut self, text: &str) {
        let line = sentence::command(text);
        self.calls.command(line.as_bytes());
        self.receive(|receiver, reported| {
            receiver.command(line.as_bytes(), reported);
            false
        });
    }

    /// Sets by key and values; the answers are those of a command.
    pub(crate) fn set(&mut self, key: &str, values: &str) {
        self.calls.set(key, values);
        let line =
            sentence::command(&if values.is_empty() { key.to_owned() } else { format!("{key},{values}") });
        self.receive(|receiver, reported| {
            receiver.command(line.as_bytes(), reported);
            false
        });
    }

    pub(crate) fn explain_receiver(&mut self) {
        self.calls.explain_receiver();
        let receiver = self.receiver.as_ref().expect("started");
        let report = receiver.last_report();
        let mut want = accuracy(report);
        want.extend(velocity(report.and_then(|_| receiver.velocity())));
        if let (Some(epoch), Some(report)) = (receiver.last_epoch(), report) {
            want.extend(residuals(epoch, report));
        }
        for (name, value) in receiver.statistics() {
            want.extend(44_u32.to_le_bytes());
            want.extend(value.to_le_bytes());
            let mut text = name.as_bytes().to_vec();
            assert!(text.len() < 36, "{name} is longer than the name of a counter");
            text.resize(36, 0);
            want.extend(text);
        }
        self.want.push(want);
    }

    fn receive(&mut self, call: impl FnOnce(&mut Receiver<MemoryPin>, &mut Vec<u8>) -> bool) {
        let mut receiver = self.receiver.take().expect("started");
        let mut reported = Vec::new();
        let judged = call(&mut receiver, &mut reported);
        self.protected += usize::from(judged && receiver.pin().high);
        let (state, reason) =
            receiver.last_verdict().map_or((0, 0), |verdict| self.state_and_reason(verdict));
        let mut want = vec![judged.into(), receiver.pin().high.into(), state, reason];
        want.extend(match receiver.last_report() {
            Some(report) => self.of_report(report),
            None => without_position(state, reason),
        });
        want.extend(reported);
        self.want.push(want);
        self.receiver = Some(receiver);
    }

    fn state_and_reason(&self, verdict: Verdict) -> (u8, u8) {
        let (state, reason) = match verdict {
            Verdict::Protected(reason) => ("PROTECTED", format!("{reason:?}")),
            Verdict::Alert(reason) => ("ALERT", format!("{reason:?}")),
            Verdict::Unavailable(reason) => ("UNAVAILABLE", format!("{reason:?}")),
        };
        let reason = self.constant(&format!("RAI_REASON_{}", reason.to_uppercase()));
        (self.constant(&format!("RAI_STATE_{state}")), reason)
    }

    /// Returns `rai_verdict_t` as the header defines it.
    fn of_report(&self, report: &Report<CAPACITY>) -> Vec<u8> {
        let (state, reason) = self.state_and_reason(report.verdict);
        let mut bytes = 168_u32.to_le_bytes().to_vec();
        let dof = report.test.map_or(0, |test| test.dof);
        let (used, excluded) = (report.used.len() as u8, report.excluded.len() as u8);
        bytes.extend([state, reason, report.tracked, used, dof, excluded, 0, 0, 0, 0, 0, 0]);
        bytes.extend(doubles(report.test.map_or([f64::NAN; 2], |test| [test.statistic, test.threshold])));
        bytes.extend(doubles(report.protection.map_or([f64::NAN; 2], |levels| [levels.hpl_m, levels.vpl_m])));
        bytes.extend(doubles(report.solution.as_ref().map_or([f64::NAN; 6], |solution| {
            let (place, geodetic) = (solution.position, solution.geodetic);
            let angles = [geodetic.latitude_rad, geodetic.longitude_rad];
            [place.x_m, place.y_m, place.z_m, angles[0], angles[1], geodetic.height_m]
        })));
        for suspect in &report.excluded {
            bytes.extend(doubles([suspect.bias_m, suspect.w_test]));
            let satellite = suspect.satellite;
            let (letter, number) = satellite.name();
            bytes.extend([letter as u8, number, 0, 0, 0, 0, 0, 0]);
        }
        bytes.resize(168, 0);
        bytes
    }
}

fn doubles<const K: usize>(numbers: [f64; K]) -> impl Iterator<Item = u8> {
    numbers.into_iter().flat_map(f64::to_le_bytes)
}

/// Returns `rai_accuracy_t` as the header defines it.
fn accuracy(report: Option<&Report<CAPACITY>>) -> Vec<u8> {
    let mut bytes = 128_u32.to_le_bytes().to_vec();
    let suspect = report.and_then(|report| report.suspect);
    let (letter, number) = suspect.map_or(('\0', 0), |suspect| suspect.satellite.name());
    bytes.extend([letter as u8, number, 0, 0]);
    bytes.extend(doubles([suspect.map_or(f64::NAN, |suspect| suspect.w_test)]));
    let nothing = [f64::NAN; 4];
    let solution = report.and_then(|report| report.solution.as_ref());
    bytes.extend(doubles(solution.map_or([f64::NAN; 6], |solution| solution.covariance_m2)));
    let rms_m = solution.and(report).map_or(f64::NAN, |report| report.residual_rms_m);
    bytes.extend(doubles(solution.map_or([f64::NAN; 2], |solution| [solution.hdop, solution.vdop])));
    bytes.extend(doubles([rms_m, report.and_then(|report| report.sigma_check).unwrap_or(f64::NAN)]));
    let [gps, beidou, galileo, glonass] =
        solution.map_or(nothing, |solution| solution.clocks_m.map(|clock_m| clock_m.unwrap_or(f64::NAN)));
    bytes.extend(doubles([gps, glonass, galileo, beidou]));
    bytes
}

/// Returns `rai_velocity_t` as the header defines it.
fn velocity(velocity: Option<&Velocity>) -> Vec<u8> {
    let mut bytes = 120_u32.to_le_bytes().to_vec();
    let Some(velocity) = velocity else {
        bytes.extend([0; 4]);
        bytes.extend(doubles([f64::NAN; 14]));
        return bytes;
    };
    bytes.extend([velocity.test.dof, velocity.excluded.len() as u8, 0, 0]);
    bytes.extend(doubles(velocity.east_north_up_m_s));
    bytes.extend(doubles(velocity.covariance_m2_s2));
    let levels = velocity.levels_m_s;
    bytes.extend(doubles([velocity.drift_m_s, levels.hpl_m, levels.vpl_m]));
    bytes.extend(doubles([velocity.test.statistic, velocity.test.threshold]));
    bytes
}

/// Returns one `rai_residual_t` for each satellite, as the header defines it.
fn residuals(epoch: &Epoch<CAPACITY>, report: &Report<CAPACITY>) -> Vec<u8> {
    let Some(solution) = &report.solution else { return Vec::new() };
    let of = |observation: &Observation| {
        let residual_m = solution.residual_m::<f32>(observation).unwrap_or(f64::NAN);
        let (letter, number) = observation.satellite.name();
        let is_used = report.used.contains(&observation.satellite);
        let mut bytes: Vec<u8> = doubles([residual_m, observation.sigma_m]).collect();
        bytes.extend([letter as u8, number, is_used.into(), 0, 0, 0, 0, 0]);
        bytes
    };
    epoch.observations().iter().flat_map(of).collect()
}

/// Returns `rai_verdict_t` without a position.
fn without_position(state: u8, reason: u8) -> Vec<u8> {
    let mut bytes = 168_u32.to_le_bytes().to_vec();
    bytes.extend([state, reason, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    bytes.extend(doubles([f64::NAN; 10]));
    bytes.resize(168, 0);
    bytes
}
