//! Every recording through the module at its start settings: levels beside errors, and the tails of
//! the normalised residuals.
//!
//! ```text
//! w       residual over its own standard deviation, by the sigmas that judged the epoch
//! tail    ranges with |w| > z over all ranges, over 2 Q(z) = 1e-2, 1e-3, 1e-4
//! ratio   median level over the 99 % quantile of the error
//! ```
//!
//! Gaussian errors as large as the sigmas have tails of 1; at most 1 means that the sigmas bound
//! them. Only protected epochs count, because the others promise nothing. `RAI_BLESS=1` writes both
//! tables.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use clap::Parser as _;
use raim::replay::command;
use rig::{document, shared};

/// Arguments of `rai replay`.
#[derive(clap::Parser)]
struct Line {
    #[command(flatten)]
    arguments: command::Arguments,
}

/// A recording of the reference folder.
struct Recorded {
    name: &'static str,
    receiver: &'static str,
    /// Arguments of `rai replay`; a path below `data/` begins with `@`.
    line: &'static str,
    /// True if the recording has two frequencies and is replayed with one as well.
    is_dual: bool,
    /// True if the sigmas must bound the tails: an antenna with a free view.
    is_bounded: bool,
}

impl Recorded {
    const fn station(name: &'static str, line: &'static str) -> Self {
        Self { name, receiver: "station", line, is_dual: true, is_bounded: true }
    }

    const fn with_one_antenna(name: &'static str, receiver: &'static str, line: &'static str) -> Self {
        Self { name, receiver, line, is_dual: false, is_bounded: true }
    }

    const fn in_a_street(name: &'static str, receiver: &'static str, line: &'static str) -> Self {
        Self { name, receiver, line, is_dual: false, is_bounded: false }
    }
}

const RECORDINGS: [Recorded; 13] = [
    Recorded::station(
        "`esbc`",
        "--obs @esbc/ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz --nav @esbc/ESBC00DNK_R_20201770000_01D_MN.rnx.gz \
         --truth=3582104.9254,532590.2381,5232755.2669",
    ),
    Recorded::station(
        "`dgar`",
        "--obs @dgar/dgar0100.24o.gz --nav @dgar/brdc0100.24n.gz --truth=1916269.37,6029977.79,-801719.83",
    ),
    Recorded::station(
        "`tlse`",
        "--obs @tlse/TLSE00FRA_R_20240011200_15M_01S_MO.crx.gz --nav @tlse/BRDC00IGS_R_20240010000_01D_MN.rnx.gz \
         --truth=4627852.50,119640.22,4372995.28",
    ),
    Recorded::station(
        "`static1hz`",
        "--obs @static1hz/base.obs.gz --nav @static1hz/base.nav.gz \
         --truth=-3817681.1213,3562839.4311,3650159.1593",
    ),
    Recorded::station(
        "`static1hz`, second receiver",
        "--obs @static1hz/rover.obs.gz --nav @static1hz/base.nav.gz \
         --truth=-3817681.3807,3562839.9785,3650158.3760",
    ),
    Recorded::station(
        "`kms3`",
        "--obs @kms3/KMS300DNK_R_20221591000_01H_30S_MO.crx --nav @kms3/KMS300DNK_R_20221591000_01H_MN.rnx.gz \
         --truth=3516213.4380,781859.8595,5246037.9660",
    ),
    Recorded::with_one_antenna(
        "`cres`",
        "station of 2008, GPS on one frequency",
        "--obs @sbas/cres.obs.gz --nav @sbas/cres.nav.gz",
    ),
    Recorded::with_one_antenna("`mosaic_12s`", "mosaic, at rest", "@sbf/mosaic_12s.sbf.gz"),
    Recorded::with_one_antenna("`f9r`", "ZED-F9R, at rest", "@real/f9r_rtcm_ubx.log.gz"),
    Recorded::with_one_antenna(
        "`x20p_walk`",
        "X20P, on foot",
        "@real/x20p_walk.ubx.gz --truth-csv @real/x20p_walk_truth.csv",
    ),
    Recorded::in_a_street(
        "`car_shanghai`",
        "car, two frequencies",
        "@consumer/car_shanghai.rtcm3.gz --truth-csv @consumer/car_shanghai_truth.csv",
    ),
    Recorded::in_a_street(
        "`car_berlin`",
        "car, M8T, one frequency",
        "--obs @consumer/car_berlin.obs.gz --nav @consumer/car_berlin.nav.gz \
         --truth-csv @consumer/car_berlin_truth.csv",
    ),
    Recorded::in_a_street(
        "`urban`",
        "car between tall buildings, M8T, one frequency",
        "--obs @urban/car.obs.gz --nav @urban/gps.nav.gz @urban/beidou.nav.gz --truth-csv @urban/truth.csv",
    ),
];

/// Probabilities of both tails together, with the quantile of the normal distribution.
const TAILS: [(f64, f64); 3] = [(1e-2, 2.575_829), (1e-3, 3.290_527), (1e-4, 3.890_592)];

/// Expected number of ranges from which a tail is shown.
const ENOUGH: f64 = 0.5;

/// Rows of a table by the names of its columns.
struct Table {
    rows: Vec<BTreeMap<String, String>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).expect("the table of a replay");
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next().expect("a heading").split(',').collect();
        let cells = |line: &str| {
            names.iter().map(|name| (*name).into()).zip(line.split(',').map(Into::into)).collect()
        };
        Self { rows: lines.map(cells).collect() }
    }

    /// Returns the time of the epochs, without gaps of more than a minute, h.
    fn hours(&self) -> f64 {
        let times: Vec<f64> = self.rows.iter().filter_map(|row| number(row, "tow")).collect();
        let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
        steps.filter(|step_s| (0.0..=60.0).contains(step_s)).sum::<f64>() / 3600.0
    }

    /// Returns the number of alerts, and of protected epochs without a satellite.
    fn signs(&self) -> usize {
        self.rows.iter().filter(|row| row["state"] == "A" || row["reason"] == "EXCLUDED").count()
    }
}

fn number(row: &BTreeMap<String, String>, name: &str) -> Option<f64> {
    row.get(name)?.parse().ok()
}

/// Returns the words of `rai replay`; `None` if a file is missing.
fn words(line: &str) -> Option<Vec<String>> {
    let path = |word: &str| match word.strip_prefix('@') {
        Some(path) => Some(shared::path_or_skip(&format!("data/{path}"))?.display().to_string()),
        None => Some(word.into()),
    };
    ["replay", "--json"].into_iter().chain(line.split_whitespace()).map(path).collect()
}

/// What a replay has shown.
struct Shown {
    epochs: usize,
    protected: usize,
    /// Time of the epochs, without gaps of more than a minute, h.
    hours: f64,
    /// Epochs with an alert of any kind, and protected ones without a satellite.
    signs: usize,
    /// Errors of protected epochs, horizontal and vertical, ascending, m.
    errors_m: [Vec<f64>; 2],
    /// Levels of protected epochs, ascending, m.
    levels_m: [Vec<f64>; 2],
    beyond: usize,
    sigma_check_pct: f64,
    /// Magnitudes of the w-tests of protected epochs: all, and without the largest of each epoch.
    w_tests: [Vec<f64>; 2],
}

impl Shown {
    /// Replays a recording; `None` if its files are missing.
    fn by(line: &str, frequency: &str) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let [epochs, satellites] = ["epochs.csv", "satellites.csv"].map(|name| folder.path().join(name));
        let mut words = words(&format!("{line} --set NOISE=AUTO --frequency {frequency}"))?;
        words.extend(["--csv".into(), epochs.display().to_string()]);
        words.extend(["--satellites".into(), satellites.display().to_string()]);
        command::run(&Line::parse_from(words).arguments, None).expect("a replay");
        Some(Self::of(&Table::read(&epochs), &Table::read(&satellites)))
    }

    fn of(epochs: &Table, satellites: &Table) -> Self {
        let mut shown = Self {
            epochs: epochs.rows.len(),
            protected: 0,
            hours: epochs.hours(),
            signs: epochs.signs(),
            errors_m: [vec![], vec![]],
            levels_m: [vec![], vec![]],
            beyond: 0,
            sigma_check_pct: 0.0,
            w_tests: [vec![], vec![]],
        };
        let mut protected = BTreeMap::new();
        let mut squares = Vec::new();
        for row in epochs.rows.iter().filter(|row| row["state"] == "P") {
            shown.protected += 1;
            protected.insert(row["tow"].clone(), Vec::new());
            squares.extend(number(row, "statistic").map(|statistic| statistic * statistic));
            for (axis, (error, level)) in
                [("horizontal_error_m", "hpl_m"), ("vertical_error_m", "vpl_m")].into_iter().enumerate()
            {
                let level_m = number(row, level).expect("a level");
                shown.levels_m[axis].push(level_m);
                if let Some(error_m) = number(row, error).map(f64::abs) {
                    shown.errors_m[axis].push(error_m);
                    shown.beyond += usize::from(error_m > level_m);
                }
            }
        }
        shown.sigma_check_pct = 100.0 * squares.iter().sum::<f64>() / squares.len() as f64;
        for row in satellites.rows.iter().filter(|row| row["used"] == "1") {
            if let (Some(of_epoch), Some(w_test)) = (protected.get_mut(&row["tow"]), number(row, "w_test")) {
                of_epoch.push(w_test.abs());
            }
        }
        for mut of_epoch in protected.into_values() {
            of_epoch.sort_by(f64::total_cmp);
            shown.w_tests[0].extend(&of_epoch);
            of_epoch.pop();
            shown.w_tests[1].extend(of_epoch);
        }
        for list in shown.errors_m.iter_mut().chain(&mut shown.levels_m) {
            list.sort_by(f64::total_cmp);
        }
        shown
    }

    /// Returns the tails over those of a Gaussian; `None` where too few ranges are expected.
    fn tails(&self, which: usize) -> [Option<f64>; 3] {
        let w_tests = &self.w_tests[which];
        TAILS.map(|(probability, quantile)| {
            let expected = probability * w_tests.len() as f64;
            let beyond = w_tests.iter().filter(|&&w_test| w_test > quantile).count() as f64;
            (expected >= ENOUGH).then_some(beyond / expected)
        })
    }

    /// Returns the cells of the table of levels.
    fn of_levels(&self) -> String {
        let median = |list: &[f64]| quantile(list, 0.5);
        let mut cells = format!("{} of {}", self.protected, self.epochs);
        let levels_m = [0, 1].map(|axis| median(&self.levels_m[axis]));
        if self.errors_m[0].len() < 20 {
            write!(cells, " | – | – | {:.1} / {:.1} | –", levels_m[0], levels_m[1]).unwrap();
            return cells;
        }
        let rms_m = self.errors_m.each_ref().map(|list| {
            (list.iter().map(|error_m| error_m * error_m).sum::<f64>() / list.len() as f64).sqrt()
        });
        let most_m = self.errors_m.each_ref().map(|list| quantile(list, 0.99));
        write!(
            cells,
            " | {:.2} / {:.2} | {:.2} / {:.2} | {:.1} / {:.1} | {:.1} / {:.1}",
            rms_m[0],
            rms_m[1],
            most_m[0],
            most_m[1],
            levels_m[0],
            levels_m[1],
            levels_m[0] / most_m[0],
            levels_m[1] / most_m[1]
        )
        .unwrap();
        cells
    }

    /// Returns the cells of the table of tails.
    fn of_tails(&self) -> String {
        let cell = |tail: Option<f64>| tail.map_or("–".into(), |tail| format!("{tail:.2}"));
        let all = self.tails(0).map(cell).join(" | ");
        let others = self.tails(1).map(cell).join(" / ");
        let is_bounded = self.tails(0).into_iter().flatten().all(|tail| tail <= 1.0);
        let bounded = if is_bounded { "yes" } else { "no" };
        format!("{} | {all} | {others} | {bounded} | {:.0}", self.w_tests[0].len(), self.sigma_check_pct)
    }
}

/// Returns a quantile of an ascending list.
fn quantile(list: &[f64], share: f64) -> f64 {
    list[((list.len() - 1) as f64 * share).round() as usize]
}

#[test]
fn results_have_the_levels_and_the_tails_of_every_recording() {
    let mut levels = String::from(
        "| recording | receiver | protected of judged | error, rms / m | error, 99 % / m | HPL / VPL, medians in m | level ÷ 99 % error |\n\
         |---|---|---|---|---|---|---|\n",
    );
    let mut tails = String::from(
        "| recording | ranges | 1e-2 | 1e-3 | 1e-4 | without the largest of each epoch | bounded | `sigma_check_pct` |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let mut hours = [(0.0, 0, 0); 2];
    for Recorded { name, receiver, line, is_dual, is_bounded } in RECORDINGS {
        let kinds: &[_] =
            if is_dual { &[("dual", ""), ("single", ", one frequency")] } else { &[("dual", "")] };
        for (frequency, what) in kinds {
            let Some(shown) = Shown::by(line, frequency) else { return };
            assert_eq!(shown.beyond, 0, "{name}{what}: errors beyond a level");
            writeln!(levels, "| {name}{what} | {receiver} | {} |", shown.of_levels()).unwrap();
            writeln!(tails, "| {name}{what} | {} |", shown.of_tails()).unwrap();
            let is_within = |which: usize| shown.tails(which).into_iter().flatten().all(|tail| tail <= 1.0);
            if *frequency == "dual" {
                let (time_h, epochs, signs) = &mut hours[usize::from(!is_bounded)];
                *time_h += shown.hours;
                *epochs += shown.epochs;
                *signs += shown.signs;
            }
            assert!(!is_bounded || is_within(0), "{name}{what}: {:?}", shown.tails(0));
        }
    }
    let mut signs =
        String::from("| recordings | hours | epochs | alerts and exclusions |\n|---|---|---|---|\n");
    for (what, (time_h, epochs, count)) in ["free view", "streets"].iter().zip(hours) {
        writeln!(signs, "| {what} | {time_h:.2} | {epochs} | {count} |").unwrap();
    }
    println!("{levels}\n{tails}\n{signs}");
    assert_eq!(hours[0].2, 0, "alerts and exclusions with a free view");
    document::must_have("results/receivers.md", "levels", &levels);
    document::must_have("results/receivers.md", "tails", &tails);
    document::must_have("results/integrity.md", "signs", &signs);
}

/// Skies of fewer satellites: systems by their letters.
const SYSTEMS: [&str; 11] = ["G", "C", "E", "R", "GC", "GE", "CE", "GR", "GCE", "GCER", "GCEJ"];

/// Alerts by which position or clock contradicts its past, which no reflection may cause.
const AGAINST_THE_PAST: [&str; 4] = ["TRACK", "CLOCK", "JUMP", "TIME"];

#[test]
fn no_choice_of_systems_shows_a_sign_of_an_attack() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("epochs.csv");
    let (mut rows, mut skies, mut hours) = (String::new(), [0; 2], [0.0; 2]);
    for Recorded { name, line, is_bounded, .. } in RECORDINGS {
        for systems in SYSTEMS {
            let Some(mut words) = words(&format!("{line} --systems {systems}")) else { return };
            words.extend(["--csv".into(), file.display().to_string()]);
            // Without a position there is nothing to judge: the receiver may not know the systems.
            if command::run(&Line::parse_from(words).arguments, None).is_err() {
                continue;
            }
            let table = Table::read(&file);
            let place = usize::from(!is_bounded);
            skies[place] += 1;
            hours[place] += table.hours();
            let against =
                |row: &&BTreeMap<String, String>| AGAINST_THE_PAST.contains(&row["reason"].as_str());
            let signs = if is_bounded { table.signs() } else { table.rows.iter().filter(against).count() };
            if signs > 0 {
                writeln!(rows, "{name}, {systems}: {signs}").unwrap();
            }
        }
    }
    assert_eq!(rows, "");
    let mut text = String::from("| recordings | choices of systems | hours |\n|---|---|---|\n");
    for (what, (skies, hours)) in ["free view", "streets"].iter().zip(skies.into_iter().zip(hours)) {
        writeln!(text, "| {what} | {skies} | {hours:.0} |").unwrap();
    }
    document::must_have("results/integrity.md", "systems", &text);
}

/// Least share of the epochs that a receiver must keep if it starts later.
const KEPT: f64 = 0.8;

#[test]
fn a_start_on_the_way_costs_no_minutes() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("epochs.csv");
    let mut lost = String::new();
    for Recorded { name, line, .. } in RECORDINGS.into_iter().filter(|recorded| !recorded.is_bounded) {
        for systems in ["GCE", "CE", "GE"] {
            let protected = |from_s: f64| {
                let mut words = words(&format!("{line} --systems {systems} --from {from_s}"))?;
                words.extend(["--csv".into(), file.display().to_string()]);
                // Without a position there is nothing to lose.
                let is_judged = command::run(&Line::parse_from(words).arguments, None).is_ok();
                let rows = if is_judged { Table::read(&file).rows } else { vec![] };
                let first_s = rows.first().and_then(|row| number(row, "tow"));
                let kept = rows.iter().filter(|row| row["state"] == "P");
                Some((first_s, kept.filter_map(|row| number(row, "tow")).collect::<Vec<f64>>()))
            };
            let Some((_, all)) = protected(0.0) else { return };
            assert!(systems != "GCE" || !all.is_empty(), "{name} is not protected at all");
            for start_s in (100..1000).step_by(100).map(f64::from) {
                let Some((Some(first_s), kept)) = protected(start_s) else { continue };
                let before = all.iter().filter(|&&time_s| time_s >= first_s).count();
                if (kept.len() as f64) < KEPT * before as f64 {
                    writeln!(lost, "{name}, {systems}, from {start_s} s: {} of {before}", kept.len())
                        .unwrap();
                }
            }
        }
    }
    assert_eq!(lost, "");
}
