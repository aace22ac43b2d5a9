//! Commands of the host port: obeyed commands, refused ones with their reasons, and that a refused
//! command changes nothing.

mod lines;
mod reported;
mod table;

use raim_core::internals::allocation::Allocation;
use raim_core::internals::integrity::raim::detection::threshold::{false_alarms, missed_detections};
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::weighting::{Ism, IsmParameters};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;
use raim_firmware::settings::{Action, CommandPort, Configuration, Order, Phase, scientific};

/// Returns a command with its checksum and line end.
fn line(body: &str) -> Vec<u8> {
    let checksum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{checksum:02X}\r\n").into_bytes()
}

/// Port with its configuration and all its answers.
struct Module {
    port: CommandPort,
    configuration: Configuration,
    answers: String,
}

impl Module {
    fn new() -> Self {
        Self { port: CommandPort::new(), configuration: Configuration::at_start(), answers: String::new() }
    }

    /// Takes bytes; returns the actions that they cause.
    fn receive(&mut self, bytes: &[u8]) -> Vec<Action> {
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

    /// Returns the bodies of the answers to one command.
    fn ask(&mut self, body: &str) -> Vec<String> {
        self.answers.clear();
        self.receive(&line(body));
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
        "OUTPUT,GSA,5",
        "OUTPUT,GNSS_INTEGRITY,1",
        "OUTPUT,RMC,0",
        "ISM,RESEARCH",
        "ISM,G,2.4,2.4,0,1e-5,1e-4",
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
    let want = Requirements::non_precision_approach()
        .with_hal_m(40.5)
        .with_val_m(Some(35.0))
        .with_false_alarm(probability(1e-5))
        .with_missed_detection(probability(1e-4))
        .with_time_to_alert_s(2.5)
        .with_allocation(Allocation::vertical());
    assert_eq!((have.requirements(), have.phase), (want, Phase::Custom));
    assert!((have.mask_rad() - std::f64::consts::FRAC_PI_6).abs() < 1e-15);
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
        let Requirements { hal_m: have_hal, val_m: have_val, .. } = module.configuration.requirements();
        assert_eq!((have_hal, have_val), (hal_m, val_m), "{phase}");
    }
}

#[test]
fn a_custom_phase_keeps_the_present_numbers() {
    let mut module = Module::new();
    module.ask("PRAIC,PHASE,LPV200");
    module.ask("PRAIC,PHASE,CUSTOM");
    // The EMT and accuracy limits of LPV-200 are not settings, so that `CUSTOM` has its allocation
    // without them.
    let want = Requirements::lpv200().with_allocation(Allocation::vertical());
    assert_eq!((module.configuration.phase, module.configuration.requirements()), (Phase::Custom, want));
}

/// Equal settings must mean equal requirements, however they came about, because neither a report
/// nor a seal could express a difference.
#[test]
fn the_same_settings_are_the_same_requirements() {
    let same = |ways: &[&[&str]]| {
        let mut settings = ways.iter().map(|commands| {
            let mut module = Module::new();
            for command in *commands {
                let answer = module.ask(&format!("PRAIC,{command}"));
                assert!(answer.iter().all(|line| line.contains(",OK")), "{answer:?}");
            }
            (module.configuration.hash(), module.configuration.requirements())
        });
        let first = settings.next().expect("a way");
        settings.for_each(|other| assert_eq!(other, first, "{ways:?}"));
    };
    same(&[
        &["PHASE,LPV200", "HAL,60", "VAL,100"],
        &["PHASE,CUSTOM", "HAL,60", "VAL,100", "TTA,6"],
        &["VAL,100", "PHASE,LPV200", "VAL,100", "HAL,60"],
    ]);
    same(&[&["HAL,50"], &["PHASE,LPV200", "VAL,OFF", "HAL,50", "TTA,10"]]);
}

#[test]
fn what_cannot_be_obeyed_is_refused_with_the_reason_and_changes_nothing() {
    let cases = [
        ("VOLUME,11", "VOLUME,ERR,unknown key"),
        ("hal,40", "hal,ERR,unknown key"),
        ("A_KEY_WITHOUT_ANY_END,1", "A_KEY_WITHOUT_AN,ERR,unknown key"),
        ("", ",ERR,unknown key"),
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
        ("TTA,10.1", "TTA,ERR,out of range"),
        ("TTA,3600", "TTA,ERR,out of range"),
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
        ("PHASE,", "PHASE,ERR,missing value"),
        ("IONO,0,0,0,0,0,0,0,0", "IONO,ERR,all zero"),
        ("IONO,0,-0,0.0,0e5,0,0,0,0", "IONO,ERR,all zero"),
        ("CLOCKAID,YES", "CLOCKAID,ERR,unknown value"),
        ("IONO,0,0,0,0,0,0,0", "IONO,ERR,missing value"),
        ("IONO,0,0,0,,0,0,0,0", "IONO,ERR,missing value"),
        ("IONO,0,0,0,0,0,0,0,0,0", "IONO,ERR,extra value"),
        ("IONO,0,0,0,x,0,0,0,0", "IONO,ERR,not a number"),
        ("IONO,1,0,0,0,0,0,0,0", "IONO,ERR,out of range"),
        ("OUTPUT,GSA", "OUTPUT,ERR,missing value"),
        ("OUTPUT,PRAIS,0", "OUTPUT,ERR,unknown value"),
        ("OUTPUT,GSA,256", "OUTPUT,ERR,out of range"),
        ("OUTPUT,GSA,1.5", "OUTPUT,ERR,out of range"),
        ("OUTPUT,GSA,1,1", "OUTPUT,ERR,extra value"),
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

/// The limits are those in the list of the interface.
#[test]
fn a_phase_bounds_its_time_to_alert() {
    let cases = [("ENROUTE", "60"), ("TERMINAL", "30"), ("NPA", "10"), ("LPV200", "6"), ("CUSTOM", "3600")];
    for (phase, most) in cases {
        let mut module = Module::new();
        module.ask(&format!("PRAIC,PHASE,{phase}"));
        let at_start_s = module.configuration.time_to_alert_s;
        assert!(at_start_s <= most.parse().expect("seconds"), "{phase} starts with {at_start_s} s");
        assert_eq!(module.ask(&format!("PRAIC,TTA,{most}")), [format!("PRAIA,TTA,{most},OK")], "{phase}");
        let kept = module.configuration;
        assert_eq!(module.ask(&format!("PRAIC,TTA,{most}.1")), ["PRAIA,TTA,ERR,out of range"], "{phase}");
        assert_eq!(module.configuration, kept, "{phase}");
        assert_eq!(module.ask("PRAIC,PHASE"), [format!("PRAIA,PHASE,{phase},OK")]);
    }
}

#[test]
fn thresholds_that_alarm_nothing_are_obeyed_with_a_warning() {
    let mut module = Module::new();
    let warned =
        |name: &str, policy: &str| format!("PRAIA,{name},OK,WARN,{policy} hardly ever alarms at this HAL");
    assert_eq!(module.ask("PRAIC,POLICY,T2"), [warned("POLICY,T2", "T2")]);
    assert_eq!(module.ask("PRAIC,POLICY,TOP"), [warned("POLICY,TOP", "TOP")]);
    assert_eq!(module.ask("PRAIC,PHASE,TERMINAL"), [warned("PHASE,TERMINAL", "TOP")]);
    assert_eq!(module.ask("PRAIC,MASK,5"), ["PRAIA,MASK,5,OK"]);
    assert_eq!(module.ask("PRAIC,PHASE,LPV200"), ["PRAIA,PHASE,LPV200,OK"]);
    assert_eq!(module.ask("PRAIC,HAL,556"), [warned("HAL,556", "TOP")]);
    assert_eq!(module.ask("PRAIC,POLICY,T1"), ["PRAIA,POLICY,T1,OK"]);
}

#[test]
fn promise_that_nothing_fails_is_obeyed_with_a_warning() {
    let mut module = Module::new();
    for (fault, is_warned) in [("0", true), ("1e-12", true), ("2e-8", false), ("1e-5", false)] {
        let asked = format!("ISM,E,6,4,0,{fault},0");
        let warning = if is_warned { ",WARN,faults so unlikely are not watched for" } else { "" };
        assert_eq!(module.ask(&format!("PRAIC,{asked}")), [format!("PRAIA,{asked},OK{warning}")]);
    }
    module.ask("PRAIC,ISM,E,6,4,0,0,0");
    assert_eq!(module.ask("PRAIC,ISM,ICAO"), ["PRAIA,ISM,ICAO,OK"]);
}

#[test]
fn proof_without_a_key_is_demanded_with_a_warning() {
    let mut module = Module::new();
    for (word, is_warned) in [("OFF", false), ("SAY", false), ("PREFER", true), ("ONLY", true)] {
        let warning = if is_warned { ",WARN,nothing is proved or false without KEY or ROOT" } else { "" };
        assert_eq!(module.ask(&format!("PRAIC,AUTH,{word}")), [format!("PRAIA,AUTH,{word},OK{warning}")]);
    }
    module.ask("PRAIC,ROOT,832E15EDE55655EAC6E399A539477B7C034CCE24C3C93FFC904ACD9BF842F04E");
    assert_eq!(module.ask("PRAIC,AUTH,ONLY"), ["PRAIA,AUTH,ONLY,OK"]);
}

#[test]
fn a_key_without_a_value_answers_what_is_in_force() {
    let mut module = Module::new();
    let at_start = [
        ("PHASE", "NPA"),
        ("HAL", "556"),
        ("VAL", "OFF"),
        ("PFA", "3.33e-7"),
        ("PMD", "1e-3"),
        ("TTA", "10"),
        ("MASK", "10"),
        ("POLICY", "T1"),
        ("METHOD", "AUTO"),
        ("CLOCKAID", "OFF"),
        ("IONO", "AUTO"),
    ];
    for (key, value) in at_start {
        assert_eq!(module.ask(&format!("PRAIC,{key}")), [format!("PRAIA,{key},{value},OK")]);
    }
    assert_eq!(module.configuration, Configuration::at_start(), "a question changes nothing");
    for (key, value) in
        [("VAL", "35.5"), ("PFA", "1e-4"), ("MASK", "5"), ("METHOD", "RANSAC"), ("CLOCKAID", "ON")]
    {
        module.ask(&format!("PRAIC,{key},{value}"));
        assert_eq!(module.ask(&format!("PRAIC,{key}")), [format!("PRAIA,{key},{value},OK")]);
    }
}

/// Eight coefficients do not fit into one answer.
#[test]
fn a_long_answer_is_continued_in_another() {
    let mut module = Module::new();
    let set = "1.024454832E-08,1.490116119E-08,-5.960464478E-08,-1.192092896E-07,88064,32768,-196608,-327680";
    module.ask(&format!("PRAIC,IONO,{set}"));
    let answers = module.ask("PRAIC,IONO");
    assert!(answers.len() > 1, "{answers:?}");
    let strip = |answer: &String| {
        answer.strip_prefix("PRAIA,IONO,").and_then(|rest| rest.strip_suffix(",OK")).map(String::from)
    };
    let reported =
        answers.iter().map(strip).collect::<Option<Vec<_>>>().expect("key and OK around each part").join(",");
    let numbers = |text: &str| {
        text.split(',').map(|number| number.parse::<f64>().expect("a number")).collect::<Vec<_>>()
    };
    assert_eq!(numbers(&reported), numbers(set));
}

#[test]
fn the_promises_of_one_system_replace_those_of_the_preset_until_the_next_preset() {
    let mut module = Module::new();
    for command in ["ISM,RESEARCH-AIR", "ISM,E,6,4.5,0.75,0,2e-4", "ISM,G,2.4,2.4,0,1e-5,1e-4"] {
        module.ask(&format!("PRAIC,{command}"));
    }
    let mut want = Ism::RESEARCH_AIRBORNE;
    let support = |ura_m, ure_m, bias_m, satellite_fault, constellation_fault| IsmParameters {
        ura_m,
        ure_m,
        bias_m,
        satellite_fault,
        constellation_fault,
    };
    want.constellations[Constellation::Gps as usize] = support(2.4, 2.4, 0.0, 1e-5, 1e-4);
    want.constellations[Constellation::Galileo as usize] = support(6.0, 4.5, 0.75, 0.0, 2e-4);
    assert_eq!(module.configuration.promises.ism(), want);
    let reported = "PRAIA,ISM,RESEARCH-AIR,G,2.4,2.4,0,1e-5,1e-4,E,6,4.5,0.75,0,2e-4,OK";
    assert_eq!(module.ask("PRAIC,ISM"), [reported]);
    module.ask("PRAIC,ISM,ICAO");
    assert_eq!(module.configuration.promises.ism(), Ism::ICAO);
    assert_eq!(module.ask("PRAIC,ISM"), ["PRAIA,ISM,ICAO,OK"]);
}

#[test]
fn promises_that_no_system_makes_are_refused() {
    let cases = [
        ("ISM,G", "missing value"),
        ("ISM,G,2.4,2.4,0,1e-5", "missing value"),
        ("ISM,G,2.4,2.4,0,1e-5,1e-4,1", "extra value"),
        ("ISM,J,2.4,2.4,0,1e-5,1e-4", "unknown value"),
        ("ISM,GE,2.4,2.4,0,1e-5,1e-4", "unknown value"),
        ("ISM,G,0,0,0,1e-5,1e-4", "out of range"),
        ("ISM,G,101,2.4,0,1e-5,1e-4", "out of range"),
        ("ISM,G,2.4,2.5,0,1e-5,1e-4", "out of range"),
        ("ISM,G,2.4,2.4,-1,1e-5,1e-4", "out of range"),
        ("ISM,G,2.4,2.4,0,0.2,1e-4", "out of range"),
        ("ISM,G,2.4,2.4,0,1e-5,1e-13", "out of range"),
        ("ISM,G,2.4,2.4,0,1e-5,x", "not a number"),
    ];
    for (command, why) in cases {
        let mut module = Module::new();
        assert_eq!(module.ask(&format!("PRAIC,{command}")), [format!("PRAIA,ISM,ERR,{why}")], "{command}");
        assert_eq!(module.configuration, Configuration::at_start());
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
fn actions_are_for_the_receiver_to_carry_out() {
    let cases = [
        ("STATS", Action::Order(Order::Statistics), None),
        ("SELFTEST", Action::Order(Order::SelfTest), None),
        ("RESET", Action::Order(Order::Reset), Some("PRAIA,RESET,OK")),
        ("TTA,6", Action::Reconfigured, Some("PRAIA,TTA,6,OK")),
    ];
    for (command, action, answer) in cases {
        let mut module = Module::new();
        assert_eq!(module.receive(&line(&format!("PRAIC,{command}"))), [action]);
        assert_eq!(module.bodies(), answer.into_iter().collect::<Vec<_>>());
    }
}
