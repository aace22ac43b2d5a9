//! `PRAIQ`: everything in force, and its hash.

use crc::{CRC_32_ISO_HDLC, Crc};
use raim_firmware::settings::Configuration;

use super::Module;

/// Returns the sentences, joined into the fields that they carry, with the hash that all of them
/// name.
pub(super) fn settings(configuration: &Configuration) -> (String, Vec<String>) {
    let mut room = [0; 1024];
    let mut free = room.as_mut_slice();
    configuration.write(&mut free).expect("enough room");
    let left = free.len();
    let text = std::str::from_utf8(&room[..1024 - left]).expect("ASCII").to_string();
    let (mut hash, mut fields) = (String::new(), Vec::new());
    let count = text.lines().count().to_string();
    for (index, line) in text.lines().enumerate() {
        assert!(line.len() + 2 <= 82, "{line}");
        let body = &line[1..line.len() - 3];
        let all: Vec<&str> = body.split(',').collect();
        let [head, middle @ .., number, of] = all.as_slice() else { panic!("{line}") };
        assert_eq!((*head, *number, *of), ("PRAIQ", (index + 1).to_string().as_str(), count.as_str()));
        hash = middle[0].to_string();
        fields.extend(middle[1..].iter().map(ToString::to_string));
    }
    (hash, fields)
}

/// Returns the CRC-32 of Ethernet.
fn crc32(text: &str) -> u32 {
    Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(text.as_bytes())
}

#[test]
fn all_settings_are_said_in_the_order_of_the_interface() {
    let (hash, fields) = settings(&Configuration::at_start());
    assert_eq!(fields[..4], ["NPA", "556", "", "3.33e-7"]);
    assert_eq!((fields[6].as_str(), fields[7].as_str(), fields[8].as_str()), ("10", "T1", "AUTO"));
    assert_eq!(hash, format!("{:08X}", crc32(&fields.join(","))));
    // As the example of the interface has it, which hosts compare with.
    assert_eq!((hash.as_str(), fields.len()), ("445D89E6", 68));
}

#[test]
fn the_longest_settings_take_several_sentences_and_lose_nothing() {
    let mut module = Module::new();
    for command in [
        "PFA,6.666666667e-5",
        "HAL,99999.9",
        "VAL,99999.9",
        "TTA,3599.9",
        "METHOD,SIMULTANEOUS",
        "IONO,1.024454832E-08,1.490116119E-08,-5.960464478E-08,-1.192092896E-07,88064,32768,-196608,-327680",
    ] {
        module.ask(&format!("PRAIC,{command}"));
    }
    let (hash, fields) = settings(&module.configuration);
    assert_eq!(fields.len(), settings(&Configuration::at_start()).1.len());
    assert_eq!(fields[26..30], ["88064", "32768", "-196608", "-327680"]);
    assert_eq!(hash, format!("{:08X}", crc32(&fields.join(","))));
}

#[test]
fn every_change_changes_the_hash() {
    let commands = [
        "PHASE,LPV200",
        "HAL,555.9",
        "VAL,50",
        "PFA,1e-4",
        "PMD,1e-4",
        "PFF,1e-6",
        "TTA,9.9",
        "POLICY,T2",
        "METHOD,RANSAC",
        "LEVELS,SLOPE",
        "SYSTEMS,GE",
        "MASK,9.9",
        "CLOCKAID,ON",
        "CN0MASK,29",
        "VMAX,100",
        "HEIGHT,-499,9000",
        "RECOVER,4,3",
        "FREQ,DUAL",
        "NOISE,CONSUMER",
        "BAUD,9600",
        "OUTPUT,GBS,3",
        "IONO,1E-8,0,0,0,0,0,0,0",
        "ISM,RESEARCH",
        "ISM,G,2.4,2.4,0,1e-5,1e-4",
    ];
    let mut hashes = vec![Configuration::at_start().hash()];
    for command in commands {
        let mut module = Module::new();
        module.ask(&format!("PRAIC,{command}"));
        hashes.push(module.configuration.hash());
    }
    let all = hashes.len();
    hashes.sort_unstable();
    hashes.dedup();
    assert_eq!(hashes.len(), all);
}
