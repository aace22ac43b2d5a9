//! Bytes of the host port: what of them is a command at all.

use proptest::prelude::*;
use raim_firmware::ring::Ring;
use raim_firmware::settings::{Action, Configuration, MAX_LINE};

use super::{Module, line};

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
        assert_eq!(module.receive(bytes), []);
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
    assert_eq!(Module::new().receive(&lower), [Action::Reconfigured]);
}

#[test]
fn a_command_in_pieces_is_one_command() {
    let mut module = Module::new();
    let bytes = line("PRAIC,HAL,40");
    let (first, second) = bytes.split_at(7);
    assert_eq!(module.receive(first), []);
    assert_eq!(module.receive(second), [Action::Reconfigured]);
}

/// Two equal characters that are missing leave the checksum right: 556 m would become 6 m.
#[test]
fn a_line_that_lost_characters_in_the_ring_is_no_command() {
    let ring = Ring::<16>::new();
    let mut module = Module::new();
    let all = [&b"\r\n\r\n\n"[..], &line("PRAIC,HAL,556")].concat();
    // The loop is late until both fives are lost.
    all[..18].iter().for_each(|byte| _ = ring.push(*byte));
    let read = |module: &mut Module| {
        while let Some(byte) = ring.pop() {
            assert_eq!(module.receive(&[byte]), []);
        }
    };
    read(&mut module);
    all[18..].iter().for_each(|byte| _ = ring.push(*byte));
    read(&mut module);
    assert_eq!((ring.dropped(), module.counter("cmd_noise"), module.counter("cmd_ok")), (2, 1, 0));
    assert_eq!(module.configuration, Configuration::at_start());
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
        module.receive(noise);
        assert_eq!(module.configuration, Configuration::at_start(), "{noise:?}");
        assert_eq!(module.receive(&good), [Action::Reconfigured], "{noise:?}");
    }
}

#[test]
fn what_is_no_command_is_counted_and_not_answered() {
    let mut module = Module::new();
    module.receive(b"$GNGNS,120000.00,,,,,N,00,,,,,,V*00\r\n$PRAIC,HAL\x00,40*00\r\n$PRAIC,H");
    module.receive(&line("PRAIS,120000.00,P"));
    assert_eq!(module.answers, "");
    assert_eq!((module.counter("cmd_foreign"), module.counter("cmd_noise")), (2, 2));
}

#[test]
fn a_line_that_is_too_long_is_refused_and_the_next_one_obeyed() {
    let mut module = Module::new();
    let longest = format!("PRAIC,HAL,{}40", "0".repeat(MAX_LINE - 15));
    assert_eq!(longest.len() + 3, MAX_LINE);
    assert_eq!(module.receive(&line(&longest)), [Action::Reconfigured]);
    assert_eq!(module.bodies(), ["PRAIA,HAL,OK"]);
    module.answers.clear();
    assert_eq!(module.receive(&line(&longest.replace("40", "040"))), []);
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
            let actions = module.receive(&[byte]);
            let answer = module.bodies().concat();
            let said_so =
                actions == [Action::Reconfigured] && (answer.ends_with(",OK") || answer.contains(",OK,WARN,"));
            prop_assert!(said_so || module.configuration == before);
            prop_assert!(module.answers.split_inclusive('\n').all(|answer| answer.len() <= 82));
        }
        let Configuration { mask_deg, klobuchar, .. } = module.configuration;
        prop_assert!(module.configuration.requirements().validate().is_ok());
        prop_assert!((0.0..=60.0).contains(&mask_deg));
        prop_assert!(klobuchar.is_none_or(|coefficients| coefficients.iter().all(|c| c.is_finite())));
    }
}
