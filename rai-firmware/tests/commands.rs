//! The host port's commands: what is obeyed, what is refused and why, and that what is refused changes nothing.

use proptest::prelude::*;
use rai_core::probability::Probability;
use rai_core::requirements::Requirements;
use rai_core::threshold::{false_alarms, missed_detections};
use rai_firmware::config::{Action, CommandPort, Configuration, MAX_LINE, Phase, scientific};

/// A command with its checksum and line end.
fn line(body: &str) -> Vec<u8> {
    let checksum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{checksum:02X}\r\n").into_bytes()
}

/// A port with its configuration, and all that it answered.
struct Module {
    port: CommandPort,
    configuration: Configuration,
    answers: String,
}

impl Module {
    fn new() -> Self {
        Self { port: CommandPort::new(), configuration: Configuration::at_start(), answers: String::new() }
    }

    /// Hears bytes; the actions they cause.
    fn hear(&mut self, bytes: &[u8]) -> Vec<Action> {
        let mut actions = Vec::new();
        for byte in bytes {
            let mut room = [0; 128];
            let mut free = room.as_mut_slice();
            let heard = self.port.push(*byte, &mut self.configuration, &mut free);
            heard.answered.expect("enough room");
            let left = free.len();
            self.answers.push_str(std::str::from_utf8(&room[..128 - left]).expect("ASCII"));
            actions.extend(heard.action);
        }
        actions
    }

    /// The bodies of the answers to one command.
    fn ask(&mut self, body: &str) -> Vec<String> {
        self.answers.clear();
        self.hear(&line(body));
        self.bodies()
    }

    fn bodies(&self) -> Vec<String> {
        self.answers.lines().map(|answer| answer[1..answer.len() - 3].to_string()).collect()
    }

    fn counter(&self, wanted: &str) -> u32 {
        self.port.counters().find(|(name, _)| *name == wanted).expect("a counter").1
    }
}

#[test]
fn each_command_is_obeyed_and_its_answer_repeats_it() {
    let commands = [
        "PHASE,ENROUTE",
        "PHASE,TERMINAL",
        "PHASE,NPA",
        "PHASE,LPV200",
        "PHASE,CUSTOM",
        "HAL,40",
        "VAL,35.5",
        "VAL,OFF",
        "PFA,1e-4",
        "PMD,1e-3",
        "TTA,6",
        "MASK,5",
        "POLICY,T1",
        "POLICY,T2",
        "POLICY,TOP",
        "METHOD,SIMULTANEOUS",
        "METHOD,SEQUENTIAL",
        "METHOD,HYBRID",
        "METHOD,GROUPING",
        "METHOD,RANSAC",
        "METHOD,BAARDA",
        "CLOCKAID,ON",
        "CLOCKAID,OFF",
        "RESET",
        "IONO,1E-8,0,-6E-8,0,9E4,0,-2E5,0",
    ];
    let mut module = Module::new();
    for command in commands {
        assert_eq!(module.ask(&format!("PRAIC,{command}")), [format!("PRAIA,{command},OK")]);
    }
    assert_eq!(module.counter("cmd_ok") as usize, commands.len());
}

#[test]
fn what_is_set_is_what_the_configuration_holds() {
    let mut module = Module::new();
    for command in ["HAL,40.5", "VAL,35", "PFA,1e-5", "PMD,1e-4", "TTA,2.5", "MASK,30"] {
        module.ask(&format!("PRAIC,{command}"));
    }
    module.ask("PRAIC,IONO,1.0245E-08,1.4901E-08,-5.9605E-08,-1.1921E-07,8.8064E+04,3.2768E+04,-1.9661E+05,-3.2768E+05");
    let have = module.configuration;
    let probability = |tail| Probability::new(tail).expect("a tail");
    let want = Requirements {
        hal_m: 40.5,
        val_m: Some(35.0),
        false_alarm: probability(1e-5),
        missed_detection: probability(1e-4),
        time_to_alert_s: 2.5,
        guard_fraction: 0.95,
    };
    assert_eq!((have.requirements, have.phase), (want, Phase::Custom));
    assert!((have.mask_rad - std::f64::consts::FRAC_PI_6).abs() < 1e-15);
    let want = [1.0245e-8, 1.4901e-8, -5.9605e-8, -1.1921e-7, 8.8064e4, 3.2768e4, -1.9661e5, -3.2768e5];
    assert_eq!(have.klobuchar, Some(want));
}

#[test]
fn phases_bring_the_limits_of_the_interface() {
    let cases = [
        ("ENROUTE", 3704.0, None),
        ("TERMINAL", 1852.0, None),
        ("NPA", 556.0, None),
        ("LPV200", 40.0, Some(35.0)),
    ];
    for (phase, hal_m, val_m) in cases {
        let mut module = Module::new();
        module.ask("PRAIC,HAL,1");
        module.ask(&format!("PRAIC,PHASE,{phase}"));
        let Requirements { hal_m: have_hal, val_m: have_val, .. } = module.configuration.requirements;
        assert_eq!((have_hal, have_val), (hal_m, val_m), "{phase}");
    }
}

#[test]
fn a_custom_phase_keeps_the_present_numbers() {
    let mut module = Module::new();
    module.ask("PRAIC,PHASE,LPV200");
    let before = module.configuration.requirements;
    module.ask("PRAIC,PHASE,CUSTOM");
    assert_eq!((module.configuration.phase, module.configuration.requirements), (Phase::Custom, before));
}

#[test]
fn what_cannot_be_obeyed_is_refused_with_the_reason_and_changes_nothing() {
    let cases = [
        ("VOLUME,11", "VOLUME,ERR,unknown key"),
        ("hal,40", "hal,ERR,unknown key"),
        ("A_KEY_WITHOUT_ANY_END,1", "A_KEY_WITHOUT_AN,ERR,unknown key"),
        ("", ",ERR,unknown key"),
        ("HAL", "HAL,ERR,missing value"),
        ("HAL,", "HAL,ERR,missing value"),
        ("HAL,40,35", "HAL,ERR,extra value"),
        ("HAL,0", "HAL,ERR,out of range"),
        ("HAL,-40", "HAL,ERR,out of range"),
        ("HAL,1e6", "HAL,ERR,out of range"),
        ("HAL,1e400", "HAL,ERR,not a number"),
        ("HAL,nan", "HAL,ERR,not a number"),
        ("HAL,inf", "HAL,ERR,not a number"),
        ("HAL,4 0", "HAL,ERR,not a number"),
        ("VAL,on", "VAL,ERR,not a number"),
        ("TTA,0", "TTA,ERR,out of range"),
        ("TTA,3601", "TTA,ERR,out of range"),
        ("MASK,-1", "MASK,ERR,out of range"),
        ("MASK,60.01", "MASK,ERR,out of range"),
        ("PFA,0", "PFA,ERR,out of range"),
        ("PFA,0.5", "PFA,ERR,out of range"),
        ("PFA,1e-400", "PFA,ERR,out of range"),
        ("PFA,3.3e-7", "PFA,ERR,nearest 3.33e-7"),
        ("PMD,1.1e-3", "PMD,ERR,nearest 1e-3"),
        ("PHASE,CRUISE", "PHASE,ERR,unknown value"),
        ("PHASE,npa", "PHASE,ERR,unknown value"),
        ("POLICY,T3", "POLICY,ERR,unknown value"),
        ("METHOD,SEPARATION", "METHOD,ERR,not in this build"),
        ("CLOCKAID,YES", "CLOCKAID,ERR,unknown value"),
        ("IONO,0,0,0,0,0,0,0", "IONO,ERR,missing value"),
        ("IONO,0,0,0,,0,0,0,0", "IONO,ERR,missing value"),
        ("IONO,0,0,0,0,0,0,0,0,0", "IONO,ERR,extra value"),
        ("IONO,0,0,0,x,0,0,0,0", "IONO,ERR,not a number"),
        ("IONO,1,0,0,0,0,0,0,0", "IONO,ERR,out of range"),
        ("STATS,ALL", "STATS,ERR,extra value"),
        ("SELFTEST,1", "SELFTEST,ERR,extra value"),
        ("RESET,NOW", "RESET,ERR,extra value"),
    ];
    for (command, want) in cases {
        let mut module = Module::new();
        let have = module.ask(&format!("PRAIC,{command}"));
        assert_eq!(have, [format!("PRAIA,{want}")], "{command}");
        assert_eq!(module.configuration, Configuration::at_start(), "{command}");
        assert_eq!(module.counter("cmd_refused"), 1, "{command}");
    }
}

#[test]
fn every_probability_of_the_tables_is_understood_by_its_name() {
    for (key, table) in [("PFA", false_alarms()), ("PMD", missed_detections())] {
        for probability in table {
            let command = format!("{key},{}", scientific(probability.get()));
            assert_eq!(Module::new().ask(&format!("PRAIC,{command}")), [format!("PRAIA,{command},OK")]);
        }
    }
}

#[test]
fn a_line_with_a_bad_checksum_is_refused() {
    let cases: [&[u8]; 6] = [
        b"$PRAIC,HAL,40*00\r\n",
        b"$PRAIC,HAL,40\r\n",
        b"$PRAIC,HAL,40*\r\n",
        b"$PRAIC,HAL,40*4\r\n",
        b"$PRAIC,HAL,40*+4\r\n",
        b"$PRAIC,HAL,40*4444\r\n",
    ];
    for bytes in cases {
        let mut module = Module::new();
        assert_eq!(module.hear(bytes), []);
        assert_eq!(module.bodies(), ["PRAIA,HAL,ERR,checksum"]);
        assert_eq!(module.configuration, Configuration::at_start());
        assert_eq!((module.counter("cmd_checksum"), module.counter("cmd_refused")), (1, 1));
    }
}

#[test]
fn a_checksum_in_lower_case_is_a_checksum() {
    let upper = line("PRAIC,TTA,6");
    let (body, checksum) = upper.split_at(upper.len() - 4);
    let lower = [body, &checksum.to_ascii_lowercase()].concat();
    assert_ne!(lower, upper, "the example needs a letter in its checksum");
    assert_eq!(Module::new().hear(&lower), [Action::Reconfigured]);
}

#[test]
fn actions_are_for_the_receiver_to_carry_out() {
    let cases = [
        ("STATS", Action::Statistics, None),
        ("SELFTEST", Action::SelfTest, None),
        ("RESET", Action::Reset, Some("PRAIA,RESET,OK")),
        ("TTA,6", Action::Reconfigured, Some("PRAIA,TTA,6,OK")),
    ];
    for (command, action, answer) in cases {
        let mut module = Module::new();
        assert_eq!(module.hear(&line(&format!("PRAIC,{command}"))), [action]);
        assert_eq!(module.bodies(), answer.into_iter().collect::<Vec<_>>());
    }
}

#[test]
fn a_command_in_pieces_is_one_command() {
    let mut module = Module::new();
    let bytes = line("PRAIC,HAL,40");
    let (first, second) = bytes.split_at(7);
    assert_eq!(module.hear(first), []);
    assert_eq!(module.hear(second), [Action::Reconfigured]);
}

#[test]
fn garbage_costs_at_most_the_line_it_is_in() {
    let good = line("PRAIC,HAL,40");
    let garbage: [&[u8]; 8] = [
        b"",
        b"\x00\xFF\x80garbage\r\n\r\n",
        b"$",
        b"$PRAIC,HA",
        b"$PRAIC,HAL,4\x0040*00",
        b"$$$$",
        b"*55\r\n,,,",
        b"$GNGNS,120000.00,,,,,N,00,,,,,,V*00\r\n",
    ];
    for noise in garbage {
        let mut module = Module::new();
        module.hear(noise);
        assert_eq!(module.configuration, Configuration::at_start(), "{noise:?}");
        assert_eq!(module.hear(&good), [Action::Reconfigured], "{noise:?}");
    }
}

#[test]
fn what_is_no_command_is_counted_and_not_answered() {
    let mut module = Module::new();
    module.hear(b"$GNGNS,120000.00,,,,,N,00,,,,,,V*00\r\n$PRAIC,HAL\x00,40*00\r\n$PRAIC,H");
    module.hear(&line("PRAIS,120000.00,P"));
    assert_eq!(module.answers, "");
    assert_eq!((module.counter("cmd_foreign"), module.counter("cmd_noise")), (2, 2));
}

#[test]
fn a_line_that_is_too_long_is_refused_and_the_next_one_obeyed() {
    let mut module = Module::new();
    let longest = format!("PRAIC,HAL,{}40", "0".repeat(MAX_LINE - 15));
    assert_eq!(longest.len() + 3, MAX_LINE);
    assert_eq!(module.hear(&line(&longest)), [Action::Reconfigured]);
    assert_eq!(module.bodies(), ["PRAIA,HAL,OK"]);
    module.answers.clear();
    assert_eq!(module.hear(&line(&longest.replace("40", "040"))), []);
    assert_eq!(module.bodies(), ["PRAIA,,ERR,too long"]);
    assert_eq!(module.counter("cmd_too_long"), 1);
    assert_eq!(module.ask("PRAIC,HAL,50"), ["PRAIA,HAL,50,OK"]);
}

#[test]
fn coefficients_too_long_to_repeat_are_still_obeyed() {
    let mut module = Module::new();
    let have = module.ask("PRAIC,IONO,1.024454832E-08,1.490116119E-08,-5.960464478E-08,-1.192092896E-07,88064,32768,-196608,-327680");
    assert_eq!(have, ["PRAIA,IONO,OK"]);
    assert!(module.configuration.klobuchar.is_some());
}

/// Bytes that look like commands often enough to reach every branch.
fn anything() -> impl Strategy<Value = Vec<u8>> {
    let word = prop_oneof![
        Just("PHASE"),
        Just("HAL"),
        Just("VAL"),
        Just("PFA"),
        Just("IONO"),
        Just("NPA"),
        Just("1e-5"),
        Just("40"),
        Just("nan"),
        Just("1e999"),
        Just("-0"),
        Just(""),
        Just("MASK"),
        Just("STATS"),
        Just("METHOD"),
        Just("BAARDA"),
    ];
    let command =
        proptest::collection::vec(word, 0..10).prop_map(|words| line(&format!("PRAIC,{}", words.join(","))));
    let piece = prop_oneof![
        3 => command,
        2 => proptest::collection::vec(any::<u8>(), 0..40),
        1 => "[ -~]{0,300}".prop_map(String::into_bytes),
        1 => Just(b"$PRAIC,".to_vec()),
    ];
    proptest::collection::vec(piece, 0..8).prop_map(|pieces| pieces.concat())
}

proptest! {
    #[test]
    fn no_bytes_leave_an_unusable_configuration_or_change_it_without_saying_so(bytes in anything()) {
        let mut module = Module::new();
        for byte in bytes {
            let before = module.configuration;
            module.answers.clear();
            let actions = module.hear(&[byte]);
            let said_so = actions == [Action::Reconfigured] && module.bodies().concat().ends_with(",OK");
            prop_assert!(said_so || module.configuration == before);
            prop_assert!(module.answers.len() <= 82);
        }
        let Configuration { requirements, mask_rad, klobuchar, .. } = module.configuration;
        prop_assert!(requirements.validate().is_ok() && (0.0..1.05).contains(&mask_rad));
        prop_assert!(klobuchar.is_none_or(|coefficients| coefficients.iter().all(|c| c.is_finite())));
    }
}
