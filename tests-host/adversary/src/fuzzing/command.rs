//! Target: the host port, followed by a sky under the resulting settings.
//!
//! | byte | meaning |
//! |---|---|
//! | 0 | bit 0: lines keep their own checksum; otherwise each receives a correct one |
//! | 1 … | input of the host port |

use std::sync::LazyLock;

use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_firmware::settings::Configuration;

use super::module::Module;
use super::sealing::seal_lines;
use super::seeds::Sky;
use super::tape::Tape;

static SKY: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| Sky::TEN.lumps());

/// Sends the lines, then the sky.
pub fn run(input: &[u8]) {
    let mut tape = Tape::new(input);
    let keeps_checksum = tape.byte() & 1 == 1;
    let bytes = if keeps_checksum { tape.rest().to_vec() } else { seal_lines(tape.rest()) };
    let mut module = Module::new();
    for line in bytes.split_inclusive(|&byte| byte == b'\n') {
        send(&mut module, line);
    }
    for epoch in SKY.iter() {
        module.receive(epoch, 1000);
    }
    module.adds_up();
}

/// Sends a piece. At most one command ends in a piece with one line feed, or several if carriage
/// returns separate them.
fn send(module: &mut Module, piece: &[u8]) {
    for line in piece.split_inclusive(|&byte| byte == b'\r') {
        let (before, obeyed) = (module.configuration(), module.counter("cmd_ok"));
        let refused = module.counter("cmd_refused") + module.counter("cmd_too_long");
        let answers = module.obey(line);
        let after = module.configuration();
        check_configuration(&after);
        if module.counter("cmd_ok") == obeyed {
            assert_eq!(after, before, "changed by what was not obeyed: {line:?}");
        }
        let refusals = answers.lines().filter(|answer| answer.contains(",ERR,")).count();
        let counted = module.counter("cmd_refused") + module.counter("cmd_too_long") - refused;
        assert_eq!(refusals, counted, "each refusal is answered: {answers:?}");
    }
}

/// Checks that the module can work with any accepted configuration.
fn check_configuration(configuration: &Configuration) {
    let requirements = configuration.requirements();
    assert_eq!(requirements.validate(), Ok(requirements));
    assert!(Thresholds::from_tables(requirements.false_alarm, requirements.missed_detection).is_ok());
    assert!((0.0..=60.0).contains(&configuration.mask_deg));
    assert!(configuration.klobuchar.is_none_or(|all| all.iter().all(|coefficient| coefficient.is_finite())));
}
