//! Start of the image on a simulator with the clock tree of an STM32F405: labwired.
//!
//! The board's emulator has no clock controller, so the image runs there at an unreported clock.
//! labwired has one. The registers that the image leaves behind are compared with [RM0090]:
//!
//! | register | with the crystal | without |
//! |---|---|---|
//! | core, Hz | 168,000,000 by the PLL | 16,000,000 of the internal oscillator |
//! | USART1 (bus 2: core / 2), USART2 and USART3 (bus 1: core / 4), baud divider for 115,200 | 729, 365 | 139, 139 |
//! | wait states of the flash | 5 | 0 |
//! | watchdog | 32 · 2000 periods of 17 to 47 kHz | the same |
//!
//! The simulator does not show more. Version 0.25 does not execute moves between a double register
//! and two core registers, so the image ends there with a fault after 0.84 ms with the crystal. Its
//! packaged chip lacks USART3, which the script adds. Wait states cost no time in it, the supply
//! never dips, and the crystal is either ready at once or never.
//!
//! [RM0090]: raim_firmware#references

use std::process::Command;

use rig::{image, setup, skip};
use serde_json::Value;

const SCRIPT: &str = include_str!("registers.py");

/// Time in which the image gives up the crystal. The simulator's core always runs at 168 MHz, where
/// 100,000 polls take about 3 ms.
const WITHOUT_CRYSTAL: &str = "20ms";

/// Bits 2 and 3 of `RCC_CFGR`: the oscillator in use ([RM0090] §7.3.3).
///
/// [RM0090]: raim_firmware#references
const SWS: u64 = 0b1100;
const SWS_INTERNAL: u64 = 0b0000;
const SWS_PLL: u64 = 0b1000;

/// Returns the registers with and without a crystal; `None` if the simulator is missing.
fn registers() -> Option<Value> {
    let python = setup::python();
    let has_package = Command::new(&python).args(["-c", "import labwired"]).output();
    if !has_package.is_ok_and(|output| output.status.success()) {
        skip::say("labwired for Python (cargo xtask setup --consumers)");
        return None;
    }
    let image = image::build().expect("the image");
    let output = Command::new(&python)
        .args(["-c", SCRIPT])
        .arg(image)
        .arg(WITHOUT_CRYSTAL)
        .output()
        .expect("python3 was there a moment ago");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(serde_json::from_slice(&output.stdout).expect("its answer"))
}

#[test]
fn image_sets_the_clock_with_and_without_a_crystal() {
    let Some(registers) = registers() else { return };
    let have = |crystal: &str, name: &str| registers[crystal][name].as_u64().expect("a register");
    // Baud dividers are the frequency of the bus over 115,200, rounded.
    for (crystal, oscillator, wait_states, first, others) in
        [("crystal", SWS_PLL, 5, 729, 365), ("none", SWS_INTERNAL, 0, 139, 139)]
    {
        assert_eq!(have(crystal, "rcc_cfgr") & SWS, oscillator, "{crystal}: {registers}");
        assert_eq!(have(crystal, "flash_acr") & 0b111, wait_states, "{crystal}: {registers}");
        assert_eq!(have(crystal, "usart1_brr"), first, "{crystal}: {registers}");
        for port in ["usart2_brr", "usart3_brr"] {
            assert_eq!(have(crystal, port), others, "{crystal}: {registers}");
        }
        // Prescaler 3 divides by 32 ([RM0090] §21.4.2).
        assert_eq!(
            (have(crystal, "iwdg_pr"), have(crystal, "iwdg_rlr")),
            (3, 2000),
            "{crystal}: {registers}"
        );
    }
}
