//! State of the dashboard: the sentences so far, as far as they are shown.

use std::collections::{BTreeMap, VecDeque};

use raim_core::frame::Geodetic;
use raim_core::satellite::SatelliteId;
use raim_firmware::settings::{Configuration, Setting};

use super::source::Message;
use super::speed::Control;
use crate::satellites::{Account, Fate};
use crate::sentence::{self, Sentence};
use crate::verdict::{Excluded, State};

/// Number of epochs stored for the curves: ten minutes at one a second.
const MEMORY: usize = 600;

/// One epoch of the curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Time of day in UTC, s.
    pub time_s: Option<f64>,
    /// `P`, `A` or `U`.
    pub state: char,
    /// Protection levels, m.
    pub levels_m: [Option<f64>; 2],
    /// Alert limits, m.
    pub limits_m: [Option<f64>; 2],
}

/// Level of the integrity pin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pin {
    /// The level is unknown.
    #[default]
    Unknown,
    /// Level that the source reports.
    Seen(bool),
    /// Level that the verdict implies.
    Implied(bool),
}

/// A satellite that was left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// Number of epochs.
    pub epochs: u32,
    /// Last bias, m.
    pub bias_m: f64,
    /// True if the satellite was left out of the last epoch.
    pub is_now: bool,
}

/// Content of the picture.
#[derive(Clone, Debug, Default)]
pub struct Dashboard {
    /// Name of the source.
    pub source: String,
    /// Epochs, the oldest first.
    pub history: VecDeque<Point>,
    /// Last verdict.
    pub state: Option<State>,
    /// Last position.
    pub position: Option<Geodetic>,
    /// State of the pin.
    pub pin: Pin,
    /// Satellites left out so far.
    pub left_out: BTreeMap<SatelliteId, LeftOut>,
    /// Satellites of the last epoch, as far as the source knows them.
    pub satellites: Vec<Account>,
    /// Settings by name; empty ones are left out.
    pub settings: Vec<(&'static str, String)>,
    /// Hash of the settings.
    pub hash: String,
    /// Integrity category of the level.
    pub nic: Option<u8>,
    /// Jamming and spoofing, with the values of `PRAIN`.
    pub interference: [u8; 2],
    /// State of OSNMA in words, while the module states one.
    pub authentication: Option<String>,
    /// Bytes lost at the GNSS and the host port, frames refused, epochs late.
    pub losses: Option<[u64; 4]>,
    /// Counters, after a request for them.
    pub counters: BTreeMap<String, u64>,
    /// Version, commit, cause of the last start, self-test.
    pub greeting: Option<[String; 4]>,
    /// Number of lines that are not a sentence.
    pub damaged: u64,
    /// Number of epochs.
    pub epochs: u64,
    /// Reason for which the source has ended.
    pub ended: Option<String>,
    /// True if the picture is paused.
    pub is_paused: bool,
    /// Speed at which a file is shown.
    pub control: Option<Control>,
    /// True if the source takes commands.
    pub takes_commands: bool,
    /// True if the picture is the list of all satellites.
    pub shows_satellites: bool,
    /// Command that the user is typing: its key, and the value so far.
    pub prompt: Option<(&'static str, String)>,
    /// Last answer to a command.
    pub answer: Option<String>,
    incomplete_settings: Vec<String>,
    /// Satellites used, by `GSA`, before the verdict of their epoch.
    listed: Vec<Account>,
}

impl Dashboard {
    /// Returns the dashboard of a source before the first line.
    pub fn of(source: &str) -> Self {
        Self { source: source.to_owned(), ..Self::default() }
    }

    /// Takes everything that belongs together, so that no picture shows a part of it.
    pub fn take(&mut self, message: &Message) {
        for line in &message.lines {
            self.receive(line);
        }
        if let Some(is_high) = message.pin {
            self.pin = Pin::Seen(is_high);
        }
        if let Some(satellites) = &message.satellites {
            self.satellites.clone_from(satellites);
        }
    }

    /// Takes one line of the host port.
    fn receive(&mut self, line: &str) {
        match sentence::parse(line) {
            Ok(Sentence::Position(position)) => self.position = position,
            Ok(Sentence::State(state)) => self.judged(state),
            Ok(Sentence::Excluded(excluded)) => self.excluded(excluded),
            Ok(Sentence::Authentication(_) | Sentence::Other) => self.told(line),
            Err(_) => self.damaged += 1,
        }
    }

    fn judged(&mut self, state: State) {
        self.left_out.values_mut().for_each(|left_out| left_out.is_now = false);
        // A level that was seen is of another verdict.
        self.pin = Pin::Implied(state.is_protected());
        // A source that knows more sends it with the epoch.
        self.satellites = std::mem::take(&mut self.listed);
        if self.history.len() == MEMORY {
            self.history.pop_front();
        }
        self.history.push_back(Point {
            time_s: state.time_s,
            state: state.state,
            levels_m: [state.hpl_m, state.vpl_m],
            limits_m: [state.hal_m, state.val_m],
        });
        self.epochs += 1;
        self.state = Some(state);
    }

    fn excluded(&mut self, excluded: Excluded) {
        let entry = self.left_out.entry(excluded.satellite).or_insert(LeftOut {
            epochs: 0,
            bias_m: 0.0,
            is_now: true,
        });
        *entry = LeftOut { epochs: entry.epochs + 1, bias_m: excluded.bias_m, is_now: true };
        let Excluded { satellite, bias_m, w_test } = excluded;
        let mut account = Account::of(satellite, Fate::Excluded);
        (account.residual_m, account.w_test) = (Some(bias_m), Some(w_test));
        self.satellites.push(account);
    }

    /// Takes a sentence that only the module has.
    fn told(&mut self, line: &str) {
        let body = line.trim_end().trim_start_matches('$').split('*').next().unwrap_or_default();
        let fields: Vec<&str> = body.split(',').collect();
        match fields.as_slice() {
            ["PRAIN", _, hash, nic, jamming, spoofing, ..] => {
                (*hash).clone_into(&mut self.hash);
                self.nic = nic.parse().ok();
                self.interference = [jamming, spoofing].map(|number| number.parse().unwrap_or(0));
            }
            ["PRAIO", _, state, _, _, proved, unproved, wrong, _, _, rest @ ..] => {
                let apart = rest.first().filter(|apart| !apart.is_empty());
                let apart = apart.map_or(String::new(), |apart| format!(", systems {apart} m apart"));
                self.authentication =
                    Some(format!("OSNMA {state}: {proved} proved, {unproved} not, {wrong} false{apart}"));
            }
            ["PRAIQ", hash, settings @ .., number, count] => {
                self.take_settings(hash, settings, *number == "1", number == count);
            }
            ["PRAIL", losses @ ..] => {
                let counts: Vec<u64> = losses.iter().filter_map(|count| count.parse().ok()).collect();
                self.losses = counts.get(..4).and_then(|counts| counts.try_into().ok());
            }
            [talker, "A", _, numbers @ .., _, _, _, system] if talker.ends_with("GSA") => {
                self.listed.extend(numbers.iter().filter_map(|number| used(system, number)));
            }
            ["PRAIA", "STATS", ..] => self.count(&fields),
            ["PRAIA", answer @ ..] => self.answer = Some(answer.join(" ")),
            ["PRAIV", version, git, cause, selftest, ..] => {
                self.greeting = Some([version, git, cause, selftest].map(|text| (*text).to_owned()));
            }
            _ => {}
        }
    }

    /// Takes names and values of an answer to `STATS`.
    fn count(&mut self, fields: &[&str]) {
        let counters = fields.get(2..fields.len().saturating_sub(1)).unwrap_or_default();
        for pair in counters.chunks_exact(2) {
            if let Ok(count) = pair[1].parse() {
                self.counters.insert(pair[0].to_owned(), count);
            }
        }
    }

    fn take_settings(&mut self, hash: &str, fields: &[&str], is_first: bool, is_last: bool) {
        if is_first {
            self.incomplete_settings.clear();
        }
        self.incomplete_settings.extend(fields.iter().map(ToString::to_string));
        if is_last && let Some(settings) = named(&self.incomplete_settings) {
            self.settings = settings;
            self.incomplete_settings.clear();
            hash.clone_into(&mut self.hash);
        }
    }
}

/// Returns a satellite that `GSA` lists, by the system id and the number of NMEA 0183.
fn used(system: &str, number: &str) -> Option<Account> {
    /// Letter of each system id, and the difference of its numbers from those of RINEX.
    const SYSTEMS: [(char, u8); 5] = [('G', 0), ('R', 64), ('E', 0), ('C', 0), ('J', 0)];
    let number: u8 = number.parse().ok()?;
    let id: usize = system.parse().ok()?;
    let (letter, more) = *SYSTEMS.get(id.checked_sub(1)?)?;
    let own = if number > more { number - more } else { number };
    format!("{letter}{own:02}").parse().ok().map(|satellite| Account::of(satellite, Fate::Used))
}

/// Returns the settings by their keys, as far as there is room: of a setting with many fields the
/// first. `None` unless the fields are those of all settings.
fn named(mut fields: &[String]) -> Option<Vec<(&'static str, String)>> {
    let mut settings = Vec::new();
    for setting in Setting::ALL {
        let mut count = 0;
        Configuration::at_start().fields(*setting, &mut |_| count += 1);
        let (of_setting, rest) = fields.split_at_checked(count)?;
        fields = rest;
        let shown = if count <= 2 { of_setting.join(",") } else { of_setting.first()?.clone() };
        // The first of the output rates alone would be misleading.
        if *setting != Setting::Output && !shown.is_empty() {
            settings.push((setting.key(), shown));
        }
    }
    fields.is_empty().then_some(settings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::checksum::nmea_line;

    fn heard(bodies: &[&str]) -> Dashboard {
        let mut dashboard = Dashboard::of("a test");
        for body in bodies {
            dashboard.receive(&nmea_line(body));
        }
        dashboard
    }

    #[test]
    fn an_epoch_moves_the_curves_and_implies_the_pin() {
        let have = heard(&[
            "GNGNS,120000.00,5530.00,N,00829.00,E,A,09,1.00,53.1,0.0,,,S",
            "PRAIS,120000.00,P,EXCLUDED,10,9,5,0.912,1.764,12.3,18.4,40.0,35.0",
            "PRAIX,120000.00,1,G05,-23.400,81.2",
            "PRAIN,120000.00,0123ABCD,10,1,2",
        ]);
        let want = Point {
            time_s: Some(43_200.0),
            state: 'P',
            levels_m: [Some(12.3), Some(18.4)],
            limits_m: [Some(40.0), Some(35.0)],
        };
        assert_eq!((have.history.back(), have.pin), (Some(&want), Pin::Implied(true)));
        let left_out: Vec<_> =
            have.left_out.iter().map(|(id, left_out)| (id.to_string(), left_out.epochs)).collect();
        assert_eq!(left_out, [("G05".to_owned(), 1)]);
        assert_eq!((have.hash.as_str(), have.nic, have.interference), ("0123ABCD", Some(10), [1, 2]));
    }

    #[test]
    fn the_state_of_authentication_is_in_words() {
        let have = heard(&["PRAIO,120000.00,DATED,1,0,6,2,0,31,4.0,12.3"]);
        let want = "OSNMA DATED: 6 proved, 2 not, 0 false, systems 12.3 m apart";
        assert_eq!(have.authentication.as_deref(), Some(want));
        let have = heard(&["PRAIO,120000.00,WAIT,,,0,8,0,,,"]);
        assert_eq!(have.authentication.as_deref(), Some("OSNMA WAIT: 0 proved, 8 not, 0 false"));
        assert_eq!(heard(&[]).authentication, None);
    }

    #[test]
    fn a_pin_that_is_seen_is_not_implied_and_is_of_its_own_verdict() {
        let verdict = nmea_line("PRAIS,120000.00,P,OK,10,9,5,0.912,1.764,12.3,18.4,40.0,35.0");
        let mut have = heard(&[]);
        have.take(&Message { lines: vec![verdict.clone()], pin: Some(false), satellites: None });
        assert_eq!(have.pin, Pin::Seen(false));
        have.take(&Message { lines: vec![verdict], pin: None, satellites: None });
        assert_eq!(have.pin, Pin::Implied(true));
    }

    #[test]
    fn without_orbits_the_satellites_are_those_of_the_sentences() {
        let have = heard(&[
            "GPGSA,A,3,01,05,,,,,,,,,,,1.22,0.59,1.07,1",
            "GLGSA,A,3,65,88,,,,,,,,,,,1.22,0.59,1.07,2",
            "PRAIS,120000.00,P,EXCLUDED,10,9,5,0.912,1.764,12.3,18.4,40.0,35.0",
            "PRAIX,120000.00,1,E09,-23.400,81.2",
        ]);
        let names: Vec<_> =
            have.satellites.iter().map(|seen| (seen.satellite.to_string(), seen.fate)).collect();
        let want = ["G01", "G05", "R01", "R24"].map(|name| (name.to_owned(), Fate::Used));
        assert_eq!(names[..4], want);
        assert_eq!(names[4], ("E09".to_owned(), Fate::Excluded));
        assert_eq!(have.satellites[4].residual_m, Some(81.2));
    }

    #[test]
    fn settings_are_shown_when_all_their_sentences_have_come() {
        let first = "PRAIQ,CAFE0001,NPA,556,,3.33e-7,1e-3,,10,T1,BAARDA,,,10,OFF,,1,2";
        let second = format!("PRAIQ,CAFE0001{},2,2", ",".repeat(68 - 14));
        assert!(heard(&[first]).settings.is_empty());
        assert!(heard(&[&second]).settings.is_empty(), "the first was missed");
        let have = heard(&[first, &second]).settings;
        assert_eq!((have[0].0, have[0].1.as_str(), have[1].1.as_str()), ("PHASE", "NPA", "556"));
    }

    #[test]
    fn the_module_itself_is_understood() {
        let mut reported = Vec::new();
        Configuration::at_start().write(&mut reported).expect("a vector takes all");
        let mut dashboard = Dashboard::of("a test");
        for line in String::from_utf8(reported).expect("ASCII").lines() {
            dashboard.receive(line);
        }
        assert!(dashboard.settings.contains(&("HAL", "556".to_owned())), "{:?}", dashboard.settings);
        assert!(dashboard.settings.contains(&("IONO", "AUTO".to_owned())), "{:?}", dashboard.settings);
    }

    #[test]
    fn damage_is_counted_and_shown_elsewhere() {
        let mut have = heard(&["PRAIL,1,2,3,4", "PRAIA,STATS,epochs,7,crc,2,OK"]);
        have.receive("$PRAIS,1*00");
        assert_eq!((have.damaged, have.losses, have.counters.get("crc")), (1, Some([1, 2, 3, 4]), Some(&2)));
    }
}
