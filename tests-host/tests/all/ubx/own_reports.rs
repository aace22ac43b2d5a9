//! A receiver's reports on its own signals: `pyubx2` writes messages from named fields, and the
//! module reads the same fields.

use std::process::Command;

use raim_firmware::input::{
    Event, Input, Jamming, LoggedEvents, ReceiverLevels, Reporter, SelfReport, Suspicion,
};
use rig::{setup, skip};
use serde_json::Value;

/// Script that writes messages of every kind with fields drawn at random: fields and frame.
const SCRIPT: &str = r"
import json, random
from pyubx2 import UBXMessage, GET
chance = random.Random(7)
byte, word = lambda: chance.randrange(256), lambda: chance.randrange(1 << 32)
out = []
def add(kind, number, name, fields):
    frame = UBXMessage(kind, number, GET, **fields)
    assert frame.identity == name, frame.identity
    out.append({'name': name, 'fields': fields, 'frame': frame.serialize().hex()})
for _ in range(40):
    count = chance.randrange(4)
    blocks = {}
    for index in range(1, count + 1):
        blocks.update({f'blockId_{index:02d}': index, f'jammingState_{index:02d}': chance.randrange(4),
            f'antStatus_{index:02d}': byte(), f'noisePerMS_{index:02d}': word() >> 16,
            f'agcCnt_{index:02d}': word() >> 16, f'jamInd_{index:02d}': byte(), f'magQ_{index:02d}': byte()})
    add('MON', 'MON-RF', 'MON-RF', {'version': 0, 'nBlocks': count, **blocks})
    count = chance.randrange(4)
    events = {}
    for index in range(1, count + 1):
        events.update({f'timeElapsed_{index:02d}': word(), f'detectionType_{index:02d}': chance.randrange(7),
            f'eventType_{index:02d}': chance.randrange(4)})
    add('SEC', 'SEC-SIGLOG', 'SEC-SIGLOG', {'version': 1, 'numEvents': count, **events})
    count = chance.randrange(6)
    signals = {}
    for index in range(1, count + 1):
        signals.update({f'gnssId_{index:02d}': 2, f'svId_{index:02d}': index, f'cno_{index:02d}': byte(),
            f'health_{index:02d}': chance.randrange(4), f'prUsed_{index:02d}': chance.randrange(2),
            f'doCorrUsed_{index:02d}': chance.randrange(2), f'authStatus_{index:02d}': chance.randrange(2)})
    add('NAV', 'NAV-SIG', 'NAV-SIG', {'iTOW': word(), 'version': 0, 'numSigs': count, **signals})
    add('NAV', 'NAV-PL', 'NAV-PL', {'version': 1, 'tmirCoeff': byte(), 'tmirExp': chance.randrange(-128, 128),
        'plPosValid': chance.randrange(2), 'plPosFrame': chance.randrange(4), 'plVelValid': 1, 'iTOW': word(),
        'plPos1': word(), 'plPos2': word(), 'plPos3': word(), 'plVel1': word(), 'plTime': word()})
    add('NAV', 'NAV-STATUS', 'NAV-STATUS', {'iTOW': word(), 'gpsFix': 3, 'psmState': chance.randrange(4),
        'spoofDetState': chance.randrange(4), 'carrSoln': chance.randrange(4), 'ttff': word()})
    add('SEC', 'SEC-SIG', 'SEC-SIG', {'version': 1, 'jamDetEnabled': chance.randrange(2),
        'jammingState': chance.randrange(4), 'spfDetEnabled': chance.randrange(2),
        'spoofingState': chance.randrange(4)})
    add('SEC', 'SEC-SIG', 'SEC-SIG', {'version': 2, 'jamDetEnabled': chance.randrange(2),
        'jammingState': chance.randrange(4), 'spfDetEnabled': chance.randrange(2),
        'spoofingState': chance.randrange(4), 'jamNumCentFreqs': 1, 'centFreq_01': word() >> 8, 'jammed_01': 1})
print(json.dumps(out))
";

/// Returns the messages of the script; counts the test as skipped without `pyubx2`.
fn messages() -> Option<Vec<Value>> {
    let python = |script: &str| Command::new(setup::python()).args(["-c", script]).output();
    if !python("import pyubx2").is_ok_and(|output| output.status.success()) {
        skip::say("pyubx2 for Python (cargo xtask setup --consumers)");
        return None;
    }
    let output = python(SCRIPT).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

/// Returns the report that a frame carries.
fn read(frame: &str) -> SelfReport {
    let bytes: Vec<u8> =
        (0..frame.len()).step_by(2).map(|at| u8::from_str_radix(&frame[at..at + 2], 16).unwrap()).collect();
    let (mut input, mut read) = (Input::new(), None);
    input.feed(&bytes, 0, |event| {
        if let Event::SelfReport(report) = event {
            read = Some(report);
        }
    });
    read.unwrap_or_else(|| panic!("{frame} is not read: {:?}", input.counters()))
}

/// Returns the report that the fields of a message mean.
fn meant(name: &str, fields: &Value) -> SelfReport {
    let field = |name: &str| fields[name].as_i64().unwrap_or_default();
    let each = |name: &str, count: &str| -> Vec<i64> {
        (1..=field(count)).map(|index| field(&format!("{name}_{index:02}"))).collect()
    };
    let state = |number: i64| Some(Suspicion::from_number(number as u8));
    let interference =
        |reporter, jamming, spoofing| SelfReport::Interference(Jamming { reporter, jamming, spoofing });
    match name {
        "MON-RF" => {
            let worst = each("jammingState", "nBlocks").into_iter().max().unwrap_or_default();
            interference(Reporter::FrontEnd, state(worst), None)
        }
        "SEC-SIGLOG" => {
            let ages = each("timeElapsed", "numEvents");
            let kinds = each("detectionType", "numEvents").into_iter().zip(each("eventType", "numEvents"));
            let latest = |is_kind: fn(i64) -> bool| {
                let of_kind = ages.iter().zip(kinds.clone());
                let begun = of_kind.filter(|(_, (kind, event))| is_kind(*kind) && *event != 1);
                begun.map(|(age, _)| *age as u32).min()
            };
            SelfReport::Log(LoggedEvents {
                jamming_s: latest(|kind| kind == 4),
                spoofing_s: latest(|kind| kind < 4),
            })
        }
        "NAV-SIG" => SelfReport::Authentication(each("authStatus", "numSigs").iter().sum::<i64>() as u8),
        "NAV-PL" => {
            let levels = ReceiverLevels {
                frame: field("plPosFrame") as u8,
                axes_mm: ["plPos1", "plPos2", "plPos3"].map(|name| field(name) as u32),
                risk: (field("tmirCoeff") as u8, field("tmirExp") as i8),
            };
            SelfReport::Levels((field("plPosValid") == 1).then_some(levels))
        }
        "NAV-STATUS" => interference(Reporter::Navigation, None, state(field("spoofDetState"))),
        "SEC-SIG" => interference(
            Reporter::Detector,
            state(field("jamDetEnabled") * field("jammingState")),
            state(field("spfDetEnabled") * field("spoofingState")),
        ),
        other => panic!("{other}"),
    }
}

#[test]
fn fields_of_a_receivers_own_reports_survive_another_program() {
    let Some(messages) = messages() else { return };
    assert_eq!(messages.len(), 280);
    for message in messages {
        let name = message["name"].as_str().unwrap();
        let have = read(message["frame"].as_str().unwrap());
        assert_eq!(have, meant(name, &message["fields"]), "{message}");
    }
}
