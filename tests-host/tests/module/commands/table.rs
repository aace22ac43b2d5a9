//! Table of the settings: each row makes a complete setting, and INTERFACES.md has the generated
//! tables.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;
use std::{env, fs};

use raim_firmware::settings::{Configuration, Order, SEALED_BYTES, Setting, Unsealed, scientific};

use super::Module;
use super::reported::settings;

/// Returns a module that has obeyed the example of a setting, with its answer.
fn changed(setting: Setting) -> (Module, String) {
    let mut module = Module::new();
    let answer = module.ask(&format!("PRAIC,{},{}", setting.key(), setting.documentation().example));
    (module, answer.concat())
}

fn fields(configuration: &Configuration, setting: Setting) -> Vec<String> {
    let mut fields = Vec::new();
    configuration.fields(setting, &mut |field| fields.push(field.to_owned()));
    fields
}

#[test]
fn every_setting_is_read_and_changes_what_is_reported_and_its_hashes() {
    let at_start = Configuration::at_start();
    let mut hashes = vec![at_start.hash()];
    for &setting in Setting::ALL {
        let (module, answer) = changed(setting);
        let (key, have) = (setting.key(), module.configuration);
        assert!(answer.starts_with(&format!("PRAIA,{key},")) && answer.contains(",OK"), "{answer}");
        assert_ne!(fields(&have, setting), fields(&at_start, setting), "{key}");
        let rests = have.promise_hash() != at_start.promise_hash();
        assert_eq!(rests, setting.row().bears_on_promise, "{key}");
        hashes.push(have.hash());
    }
    let all = hashes.len();
    hashes.sort_unstable();
    hashes.dedup();
    assert_eq!(hashes.len(), all, "two settings have one hash");
}

#[test]
fn praiq_has_the_fields_of_every_setting_in_the_order_of_the_table() {
    for &setting in Setting::ALL {
        let (module, _) = changed(setting);
        let want: Vec<String> =
            Setting::ALL.iter().flat_map(|setting| fields(&module.configuration, *setting)).collect();
        assert_eq!(settings(&module.configuration).1, want);
    }
}

#[test]
fn every_setting_outlives_a_restart() {
    for &setting in Setting::ALL {
        let (module, _) = changed(setting);
        let mut memory = [0; SEALED_BYTES];
        module.configuration.seal(&mut memory);
        let want = Unsealed::Settings(module.configuration);
        assert_eq!(Configuration::unseal(&memory), want, "{}", setting.key());
    }
}

/// Returns a command for each word of a setting; the other values are those of its example.
fn commands(setting: Setting) -> impl Iterator<Item = String> {
    let documentation = setting.documentation();
    let rest = documentation.example.split_once(',').map_or("", |(_, rest)| rest);
    documentation.words.iter().map(move |word| match setting {
        Setting::Output => format!("{},{word},{rest}", setting.key()),
        _ => format!("{},{word}", setting.key()),
    })
}

#[test]
fn every_word_is_obeyed() {
    for command in Setting::ALL.iter().flat_map(|setting| commands(*setting)) {
        let answer = Module::new().ask(&format!("PRAIC,{command}"));
        assert!(answer.concat().starts_with(&format!("PRAIA,{command},OK")), "{answer:?}");
    }
}

#[test]
fn the_ends_of_every_range_are_obeyed_and_what_lies_beyond_is_refused() {
    let single = |setting: &&Setting| {
        let (row, example) = (setting.row(), setting.documentation().example);
        // Probabilities must be in the tables, which the ends of their range are not, and a phase
        // limits its time to alert.
        row.ranges.len() == 1 && !example.contains(',') && !["PFA", "PMD", "TTA"].contains(&row.key)
    };
    let mut count = 0;
    for setting in Setting::ALL.iter().filter(single) {
        let [(lowest, highest)] = setting.row().ranges else { unreachable!("filtered") };
        for (value, is_within) in [
            (*lowest, true),
            (*highest, true),
            (lowest - lowest.abs().max(1.0) * 1e-3, false),
            (highest * 1.001, false),
        ] {
            let command = format!("{},{value}", setting.key());
            let answer = Module::new().ask(&format!("PRAIC,{command}")).concat();
            assert_eq!(answer.contains(",OK"), is_within, "{answer}");
            assert!(is_within || answer.ends_with(",ERR,out of range"), "{answer}");
            count += 1;
        }
    }
    assert!(count >= 24, "{count}");
}

/// Items that the macro needs around it.
const AROUND: &str = r"
#![allow(dead_code, unused)]
pub struct Row {
    key: &'static str,
    ranges: &'static [(f64, f64)],
    bears_on_promise: bool,
    phase: PhaseEffect,
    warning: fn(&Configuration) -> Option<&'static str>,
}
pub struct Documentation {
    text: &'static str,
    unit: &'static str,
    fields: &'static str,
    example: &'static str,
    words: &'static [&'static str],
}
pub enum PhaseEffect { Apart }
pub trait Spelled { const RANGES: usize; const WORDS: &'static [&'static str]; }
impl Spelled for u8 { const RANGES: usize = 1; const WORDS: &'static [&'static str] = &[]; }
pub trait Value {}
impl Value for u8 {}
mod table {
    use super::*;
    use super::row::settings;
";

/// Complete row.
const ROW: &str = r#"
        field: u8 = 1,
        ranges: &[(0.0, 9.0)],
        unit: "m",
        fields: "m",
        promise: true,
        phase: Apart,
        warning: |_| None,
        example: "7",
        text: "Text",
"#;

/// Compiles a table of one row; returns the compiler's messages on failure.
fn compiled(row: &str) -> Result<(), String> {
    let macros = Path::new(env!("CARGO_MANIFEST_DIR")).join("../rai-firmware/src/settings/row.rs");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("row");
    fs::create_dir_all(&folder).expect("a folder for what is tried");
    let source = folder.join("lib.rs");
    let around = AROUND.replacen(
        "pub struct Row",
        &format!("#[path = \"{}\"] mod row;\npub struct Row", macros.display()),
        1,
    );
    let around = around.replace("Configuration)", "table::Configuration)");
    fs::write(&source, format!("{around} settings! {{ \"TOY\" Toy {{ {row} }} }} }}")).expect("a source");
    let compiler = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(compiler)
        .args(["--edition", "2024", "--crate-type", "lib", "--emit", "metadata", "--out-dir"])
        .arg(&folder)
        .arg(&source)
        .output()
        .expect("a compiler");
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
}

#[test]
fn a_row_without_one_of_its_columns_does_not_compile() {
    assert_eq!(compiled(ROW), Ok(()));
    let lines: Vec<&str> = ROW.lines().filter(|line| !line.trim().is_empty()).collect();
    for missing in 0..lines.len() {
        let row: String =
            lines.iter().enumerate().filter(|(index, _)| *index != missing).map(|(_, line)| *line).collect();
        compiled(&row).expect_err(lines[missing]);
    }
    let reported = compiled(&ROW.replace("&[(0.0, 9.0)]", "&[]")).expect_err("a number without a range");
    assert!(reported.contains("one range a number"), "{reported}");
    compiled(&ROW.replace("Apart", "Nowhere")).expect_err("an effect that there is not");
}

/// Returns a number in the form of INTERFACES.md.
fn number(value: f64) -> String {
    let size = value.abs();
    if size > 0.0 && size < 1e-2 {
        format!("{}{}", if value < 0.0 { "−" } else { "" }, scientific(size).as_str())
    } else {
        format!("{value}").replace('-', "−")
    }
}

/// Returns the values of a setting: its words, and the ranges of its numbers.
fn values(setting: Setting) -> String {
    let words = setting.documentation().words.iter().map(|word| format!("`{word}`"));
    let mut ranges: Vec<String> = Vec::new();
    for (lowest, highest) in setting.row().ranges {
        let range = if setting == Setting::Ionosphere {
            format!("±{highest:.4e}")
        } else {
            format!("{} to {}", number(*lowest), number(*highest))
        };
        if ranges.last() != Some(&range) {
            ranges.push(range);
        }
    }
    words.chain(ranges).collect::<Vec<_>>().join(", ")
}

/// Returns the value of a setting at start, in the form of a command.
fn at_start(setting: Setting) -> String {
    if setting == Setting::Output {
        return "sentences 1, `GSV` and MAVLink 0".to_owned();
    }
    let answer = Module::new().ask(&format!("PRAIC,{}", setting.key())).concat();
    let value =
        answer.strip_prefix(&format!("PRAIA,{},", setting.key())).and_then(|rest| rest.strip_suffix(",OK"));
    format!("`{}`", value.expect("one answer"))
}

/// Returns the table of the keys.
fn table_of_keys() -> String {
    let mut table =
        "| key | values | unit | at start | takes a promise back | meaning |\n|---|---|---|---|---|---|\n"
            .to_owned();
    for &setting in Setting::ALL {
        let (key, text) = (setting.key(), setting.documentation());
        let bears = if setting.row().bears_on_promise { "yes" } else { "no" };
        let (values, at_start) = (values(setting), at_start(setting));
        let _ =
            writeln!(table, "| `{key}` | {values} | {} | {at_start} | {bears} | {} |", text.unit, text.text);
    }
    for [key, values, text] in Order::ALL {
        let _ = writeln!(table, "| `{key}` | {values} | | | no | {text} |");
    }
    table
}

/// Returns the table of the fields of `PRAIQ`.
fn table_of_fields() -> String {
    let mut table = "| fields | setting | as |\n|---|---|---|\n".to_owned();
    let mut next = 1;
    for &setting in Setting::ALL {
        let count = fields(&Configuration::at_start(), setting).len();
        let last = (next + count).saturating_sub(1);
        let numbers = match count {
            0 => "then".to_owned(),
            1 => format!("{next}"),
            2 => format!("{next}, {last}"),
            _ => format!("{next} to {last}"),
        };
        let _ = writeln!(table, "| {numbers} | `{}` | {} |", setting.key(), setting.documentation().fields);
        next += count;
    }
    table
}

/// Returns the mark before a generated table.
fn mark(name: &str) -> String {
    format!("<!-- generated: {name} -->\n")
}

/// Returns the text between the marks of a generated table.
fn generated<'t>(document: &'t str, name: &str) -> &'t str {
    let rest = document.split_once(&mark(name)).map(|(_, rest)| rest).expect("a mark before the table");
    rest.split_once("<!-- end -->").map(|(table, _)| table).expect("a mark behind the table")
}

/// `RAI_BLESS=1` writes the tables into the document.
#[test]
fn interfaces_have_the_tables_of_the_settings() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../INTERFACES.md");
    let mut document = fs::read_to_string(&path).expect("INTERFACES.md");
    let tables = [("keys", table_of_keys()), ("fields", table_of_fields())];
    if env::var_os("RAI_BLESS").is_some() {
        for (name, table) in &tables {
            let mark = mark(name);
            let old = format!("{mark}{}", generated(&document, name));
            document = document.replacen(&old, &format!("{mark}{table}"), 1);
        }
        fs::write(&path, &document).expect("INTERFACES.md can be written");
    }
    for (name, want) in &tables {
        let have = generated(&document, name);
        let differs = have.lines().zip(want.lines()).find(|(have, want)| have != want);
        assert!(
            have == want,
            "INTERFACES.md, table of {name}, differs from `settings/table.rs` (RAI_BLESS=1 writes it): {differs:?}"
        );
    }
}
