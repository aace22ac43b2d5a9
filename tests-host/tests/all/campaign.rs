//! Campaigns: the same bytes for any division or interruption of the work, and refusals of wrong
//! specifications.

use std::fs;
use std::path::{Path, PathBuf};

use raim::campaign::almanac;
use raim::campaign::picture::{Case, cases, mean_over_globe, share_of_globe};
use raim::campaign::spec::Spec;
use raim::campaign::{Campaign, Share, Table, merge, write_report};
use raim::signal::sky::Fleet;
use raim_core::satellite::Constellation;
use rig::{document, shared};

/// A specification with a coarse grid, noise, every kind of fault, two masks, and methods of both
/// kinds.
const SPEC: &str = r#"
name = "small"
seed = 7
noise = 1.0
masks_deg = [5, 10]
faults = [
    { kind = "none" },
    { kind = "drawn", bias_m = [20, 100] },
    { kind = "every-satellite", bias_m = 60 },
    { kind = "constellation", shift_m = [60, 0, 0] },
]
[places]
grid_deg = 60
[times]
step_s = 7200
count = 3
[[skies]]
name = "GPS and Galileo"
fleets = ["gps31", "galileo24"]
[[errors]]
name = "ground"
user = "ground"
[[errors]]
name = "three metres"
sigma_m = 3
[judgement]
set = ["PHASE,NPA"]
methods = ["SEPARATION", "AUTO"]
levels = ["BOUND", "SLOPE"]
"#;

fn campaign(text: &str) -> Campaign {
    Campaign::of(Spec::parse(text).unwrap(), Path::new(".")).unwrap()
}

fn work(campaign: &Campaign, folder: &Path, share: Share, resume: bool) -> PathBuf {
    campaign.work(folder, share, resume, |_, _| {}).unwrap()
}

#[test]
fn the_same_specification_gives_the_same_bytes_and_another_seed_does_not() {
    let (first, second) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let text = |folder: &Path, spec: &str| {
        fs::read_to_string(work(&campaign(spec), folder, Share::ALL, false)).unwrap()
    };
    let whole = text(first.path(), SPEC);
    assert_eq!(whole, text(second.path(), SPEC));
    let table = Table::read(&whole).unwrap();
    // Two masks, two error models, 3 × 6 boxes; four faults, three judges.
    assert_eq!((table.identity.cells, table.identity.rows), (2 * 2 * 18, 4 * 3));
    assert!(table.is_whole());
    let third = tempfile::tempdir().unwrap();
    let other = text(third.path(), &SPEC.replace("seed = 7", "seed = 8"));
    assert_ne!(whole.lines().nth(2), other.lines().nth(2));
}

#[test]
fn threads_change_nothing() {
    let bytes = |threads: usize| {
        let folder = tempfile::tempdir().unwrap();
        let mut campaign = campaign(SPEC);
        campaign.threads = threads;
        let path = work(&campaign, folder.path(), Share::ALL, false);
        fs::read(path).unwrap()
    };
    assert_eq!(bytes(1), bytes(4));
}

#[test]
fn shares_merge_to_the_bytes_of_one_run_in_any_order() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = campaign(SPEC);
    let whole = fs::read_to_string(work(&campaign, folder.path(), Share::ALL, false)).unwrap();
    for shares in [2, 5, 100] {
        let share = |index| work(&campaign, folder.path(), Share { index, of: shares }, false);
        let mut files: Vec<PathBuf> = (0..shares).map(share).collect();
        files.reverse();
        assert_eq!(merge(&files).unwrap(), whole, "{shares} shares");
    }
}

#[test]
fn a_run_that_was_cut_anywhere_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = campaign(SPEC);
    let share = Share { index: 1, of: 4 };
    let path = work(&campaign, folder.path(), share, false);
    let whole = fs::read(&path).unwrap();
    for cut in [0, 10, 90, 400, whole.len() / 3, whole.len() - 1, whole.len()] {
        fs::write(&path, &whole[..cut]).unwrap();
        assert_eq!(work(&campaign, folder.path(), share, true), path);
        assert_eq!(fs::read(&path).unwrap(), whole, "cut at {cut}");
    }
}

#[test]
fn what_cannot_be_gone_on_with_is_refused_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let first = campaign(SPEC);
    let path = work(&first, folder.path(), Share::ALL, false);
    let whole = fs::read(&path).unwrap();
    let refused = |campaign: &Campaign, resume| {
        campaign.work(folder.path(), Share::ALL, resume, |_, _| {}).unwrap_err().to_string()
    };
    assert!(refused(&first, false).contains("already exists: continue with --resume"));
    let other = campaign(&SPEC.replace("count = 3", "count = 4"));
    assert!(refused(&other, true).contains("is of another specification"));
    assert_eq!(fs::read(&path).unwrap(), whole);
    fs::write(&path, "hello\n").unwrap();
    let error = first.work(folder.path(), Share::ALL, true, |_, _| {}).unwrap_err();
    assert!(format!("{error:#}").contains("the first line must be that of a campaign"), "{error:#}");
}

#[test]
fn shares_that_do_not_fit_together_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = campaign(SPEC);
    let share = |index| work(&campaign, folder.path(), Share { index, of: 3 }, false);
    let files: Vec<PathBuf> = (0..3).map(share).collect();
    let error = |files: &[PathBuf]| format!("{:#}", merge(files).unwrap_err());
    assert!(
        error(&files[..2]).contains("24 of 72 cells are missing, the first is 2"),
        "{}",
        error(&files[..2])
    );
    assert!(error(&[files.clone(), files[..1].to_vec()].concat()).contains("give each share once"));
    assert!(error(&[]).contains("nothing to merge"));
    let other = self::campaign(&SPEC.replace("seed = 7", "seed = 8"));
    let stranger = other.work(&folder.path().join("other"), Share::ALL, false, |_, _| {}).unwrap();
    assert!(error(&[files[0].clone(), stranger]).contains("are of different campaigns"));
}

/// Without noise the position is that of the antenna: ranges, clocks and the turning earth agree
/// with the module's model.
#[test]
fn without_noise_there_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let quiet = SPEC.replace("noise = 1.0", "noise = 0.0");
    let text = fs::read_to_string(work(&campaign(&quiet), folder.path(), Share::ALL, false)).unwrap();
    let table = Table::read(&text).unwrap();
    for row in table.rows.iter().filter(|row| row.text("fault") == "none") {
        assert!(row.number("horizontal_rms_m") <= 0.02 && row.number("vertical_rms_m") <= 0.02, "{row:?}");
        assert_eq!((row.text("alerts"), row.text("excluded")), ("0", "0"), "{row:?}");
    }
}

mod at_length {
    use super::*;

    /// The maps of the first campaign in the readme are those that it draws.
    #[test]
    fn the_pictures_of_the_first_campaign_are_those_that_it_draws() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let campaign = Campaign::load(&root.join("campaigns/lpv200.toml")).unwrap();
        let table = Table::read(&campaign.text(Share::ALL)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        write_report(&table, folder.path(), false).unwrap();
        for (drawn, kept) in [("map-availability", "availability"), ("map-vpl_99_m", "vpl")] {
            let drawn = fs::read_to_string(folder.path().join(format!("lpv200-{drawn}.svg"))).unwrap();
            let kept = root.join(format!("pictures/lpv200-{kept}.svg"));
            let is_same = fs::read_to_string(&kept).is_ok_and(|text| text == drawn);
            assert!(
                is_same,
                "{} is not what `cargo xtask campaign` draws now: copy its map there",
                kept.display()
            );
        }
        let cases = cases(&table);
        let of_method = |method| cases.iter().filter(move |case| case.rows[0].text("method") == method);
        let rows: String = of_method("SEPARATION").chain(of_method("AUTO")).map(row_of_results).collect();
        let head = "| method, systems | available | share of the globe with 99.5 % or more | HPL / VPL, medians |\n\
                    |---|---|---|---|\n";
        document::must_have("results/integrity.md", "lpv200", &[head, &rows].concat());
        let mean = percents(mean_over_globe(&cases[0], |row| row.number("availability")), 2);
        document::must_say("RESULTS.md", &format!("mean availability | {mean} % |"));
    }
}

/// Returns a row of the table of availability.
fn row_of_results(case: &Case<'_>) -> String {
    let method = if case.rows[0].text("method") == "SEPARATION" { "SEPARATION" } else { "BOUND" };
    let systems = if case.rows[0].text("sky").contains("BeiDou") { "and BeiDou" } else { "GPS and Galileo" };
    let mean = percents(mean_over_globe(case, |row| row.number("availability")), 2);
    let share = percents(share_of_globe(case, |row| row.number("availability") >= 0.995), 1);
    let [hpl_m, vpl_m] = ["hpl_median_m", "vpl_median_m"].map(|column| median(case, column));
    format!("| `{method}`, {systems} | {mean} % | {share} % | {hpl_m:.1} / {vpl_m:.1} m |\n")
}

/// Returns a share in percent. A share of one has no decimals.
fn percents(share: f64, decimals: usize) -> String {
    if share >= 1.0 { "100".into() } else { format!("{:.decimals$}", 100.0 * share) }
}

/// Returns the median over the boxes.
fn median(case: &Case<'_>, column: &str) -> f64 {
    let mut values: Vec<f64> = case.rows.iter().map(|row| row.number(column)).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The values of a row add up, and a fault is detected.
#[test]
fn rows_say_what_their_names_promise() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(work(&campaign(SPEC), folder.path(), Share::ALL, false)).unwrap();
    let table = Table::read(&text).unwrap();
    for row in &table.rows {
        let count = |column| row.number(column) as u64;
        assert_eq!(count("epochs"), count("protected") + count("alerts") + count("unavailable"), "{row:?}");
        if row.text("fault") == "none" {
            assert_eq!((count("epochs"), count("misleading")), (3, 0), "{row:?}");
        }
        assert!(row.text("fault") != "drawn 20 to 100 m" || count("epochs") == 3, "{row:?}");
        assert!(row.text("fault") != "constellation 60 0 0 m" || count("epochs") == 6, "{row:?}");
    }
    let noticed = |fault: &str| -> u64 {
        let rows =
            table.rows.iter().filter(|row| row.text("fault") == fault && row.text("method") == "SEPARATION");
        rows.map(|row| (row.number("alerts") + row.number("excluded")) as u64).sum()
    };
    assert_eq!(noticed("none"), 0);
    assert!(noticed("every satellite 60 m") > 100 && noticed("constellation 60 0 0 m") > 100);
    let page = write_report(&table, folder.path(), true).unwrap();
    let html = fs::read_to_string(page).unwrap();
    assert!(html.contains("SEPARATION") && html.contains("<svg") && !html.contains("<script"));
    assert!(folder.path().join("small-map-availability.svg").exists());
}

#[test]
fn points_tracks_and_almanacs_are_read() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("flight.csv"),
        "time_s,lat_deg,lon_deg,height_m\n0,48,11,500\n600,48.5,11.5,9000\n",
    )
    .unwrap();
    fs::write(folder.path().join("gps.alm"), yuma()).unwrap();
    let spec = |places: &str| {
        format!(
            "name = \"p\"\nmasks_deg = [5]\n[places]\n{places}\n[times]\nstep_s = 600\ncount = 2\n[[skies]]\nname = \
             \"both\"\nfleets = [\"galileo24\"]\nalmanacs = [{{ file = \"gps.alm\", system = \"G\" }}]\n[[errors]]\nname \
             = \"ground\"\nuser = \"ground\"\n[judgement]\nmethods = [\"AUTO\"]\n"
        )
    };
    for (places, epochs) in [
        ("points = [{ name = \"home\", lat_deg = 48, lon_deg = 11 }]", [2.0].as_slice()),
        ("track = \"flight.csv\"", &[1.0, 1.0]),
    ] {
        let spec = Spec::parse(&spec(places)).unwrap();
        let campaign = Campaign::of(spec, folder.path()).unwrap();
        let out = tempfile::tempdir().unwrap();
        let table = Table::read(&fs::read_to_string(work(&campaign, out.path(), Share::ALL, false)).unwrap())
            .unwrap();
        let have: Vec<f64> = table.rows.iter().map(|row| row.number("epochs")).collect();
        assert_eq!(have, epochs, "{places}");
        assert!(table.rows.iter().all(|row| row.number("protected") > 0.0), "{places}");
        write_report(&table, out.path(), false).unwrap();
    }
}

/// Returns the built-in GPS of 2020 in the operator's format, with the epoch at the beginning of a
/// week.
fn yuma() -> String {
    let block = |satellite: &raim::signal::sky::Satellite| {
        let orbit = satellite.orbit;
        format!(
            "******** Week 40 almanac for PRN-{0:02} ********\nID:                         {0:02}\nHealth:                     000\n\
             Eccentricity:               {1:E}\nTime of Applicability(s):  0.0000\nOrbital Inclination(rad):   {2}\n\
             Rate of Right Ascen(r/s):  {3:E}\nSQRT(A)  (m 1/2):           {4}\nRight Ascen at Week(rad):   {5}\n\
             Argument of Perigee(rad):   {6}\nMean Anom(rad):             {7}\nAf0(s):                    0.0\n\
             Af1(s/s):                  0.0\nweek:                        40\n\n",
            satellite.id.number(),
            orbit.eccentricity,
            orbit.inclination_rad,
            orbit.node_rate_rad_s,
            orbit.semi_major_axis_m.sqrt(),
            orbit.node_rad,
            orbit.perigee_rad,
            orbit.mean_anomaly_rad
        )
    };
    Fleet::Gps31.satellites().iter().map(block).collect()
}

#[test]
fn an_almanac_gives_the_orbits_that_it_was_made_of() {
    let read = almanac::read(&yuma(), Constellation::Gps).unwrap();
    let want = Fleet::Gps31.satellites();
    assert_eq!(read.len(), want.len());
    for (have, want) in read.iter().zip(&want) {
        assert_eq!(have.id, want.id);
        let distance_m = have.orbit.position(50_000.0).distance_m(want.orbit.position(50_000.0));
        assert!(distance_m < 1e-3, "{}: {distance_m} m", want.id);
    }
}

/// The node of an almanac is counted from the beginning of the week: with the epoch a quarter of a
/// day later, it has turned back with the earth by a quarter.
#[test]
fn an_almanacs_node_turns_with_the_earth_until_its_epoch() {
    let quarter_s = 86_164.090_5 / 4.0;
    let text = yuma().replace("Applicability(s):  0.0000", &format!("Applicability(s):  {quarter_s}"));
    let (later, first) = (almanac::read(&text, Constellation::Gps).unwrap(), Fleet::Gps31.satellites());
    let turned = (first[0].orbit.node_rad - later[0].orbit.node_rad).rem_euclid(std::f64::consts::TAU);
    assert!((turned - std::f64::consts::FRAC_PI_2).abs() < 1e-6, "{turned}");
}

#[test]
fn hostile_almanacs_are_refused_in_words() {
    for (text, want) in [
        (String::new(), "no healthy satellite"),
        ("ID: 1\n".to_owned(), "a block lacks `Health`"),
        (yuma().replace("ID:                         05", "ID:   0"), "the number must be within 1 to 99"),
        (yuma().replace("ID:                         05", "ID:   04"), "G04 occurs twice"),
        (yuma().replace("Mean Anom(rad):  ", "Mean Anom(rad):  x"), "is not a number"),
        (
            yuma().replace("SQRT(A)  (m 1/2):           5", "SQRT(A)  (m 1/2):           2"),
            "root of the axis",
        ),
        (
            yuma().replace("Health:                     000", "Health:                     063"),
            "no healthy satellite",
        ),
    ] {
        let have = format!("{:#}", almanac::read(&text, Constellation::Gps).unwrap_err());
        assert!(have.contains(want), "have {have}, want {want}");
    }
}

#[test]
fn hostile_specifications_are_refused_with_what_to_write_instead() {
    for (from, to, want) in [
        ("name = \"small\"", "name = \"../small\"", "write letters, digits"),
        ("noise = 1.0", "noise = nan", "noise = NaN: write a number from 0 to 100"),
        ("noise = 1.0", "nosie = 1.0", "unknown field `nosie`"),
        ("masks_deg = [5, 10]", "masks_deg = []", "masks_deg is empty: write masks_deg = [5]"),
        ("masks_deg = [5, 10]", "masks_deg = [95]", "write a number from 0 to 60"),
        ("grid_deg = 60", "grid_deg = 7", "write a step that divides 180"),
        ("grid_deg = 60", "grid_deg = 0", "places.grid_deg = 0: write a number"),
        ("grid_deg = 60", "", "places: write one of grid_deg"),
        ("grid_deg = 60", "points = []", "write at least one point"),
        ("grid_deg = 60", "track = \"nowhere.csv\"", "cannot read"),
        ("count = 3", "count = 0", "times.count: write 1 to 1000000"),
        ("count = 3", "count = -3", "invalid value"),
        ("step_s = 7200", "step_s = 0", "times.step_s = 0: write a number"),
        ("count = 3", "count = 1000000\n[x]", "unknown field `x`"),
        ("\"galileo24\"]", "\"galileo25\"]", "\"galileo25\" is not a fleet; the fleets are gps24"),
        ("\"galileo24\"]", "\"gps24\"]", "occurs twice: name one constellation per system"),
        ("fleets = [\"gps31\", \"galileo24\"]", "fleets = []", "has no satellites: write fleets"),
        ("name = \"GPS and Galileo\"", "name = \"a,b\"", "without commas"),
        ("user = \"ground\"", "user = \"moon\"", "write \"ground\" or \"airborne\""),
        ("user = \"ground\"", "", "write one of user"),
        ("sigma_m = 3", "sigma_m = 3\nzenith_m = 1", "write one of user"),
        ("name = \"three metres\"", "name = \"ground\"", "occurs twice; give each its own"),
        ("bias_m = [20, 100]", "bias_m = [100, 20]", "bias_m of `drawn` is [least, largest]"),
        ("kind = \"none\"", "kind = \"nothing\"", "unknown variant `nothing`"),
        ("PHASE,NPA", "PHASE,CRUISE", "the module refuses `PHASE,CRUISE`"),
        ("PHASE,NPA", "STATS", "`STATS` sets nothing"),
        ("\"AUTO\"", "\"MAGIC\"", "the module refuses `METHOD,MAGIC`"),
        ("methods = [\"SEPARATION\", \"AUTO\"]", "methods = []", "judgement.methods is empty"),
        ("count = 3", "count = 1000000\nstart_s = inf", "times.start_s = inf"),
    ] {
        let text = SPEC.replacen(from, to, 1);
        assert_ne!(text, SPEC, "{from}");
        let tried = Spec::parse(&text).and_then(|spec| Campaign::of(spec, Path::new("/nonexistent")));
        let have = tried.err().map_or_else(|| "accepted".to_owned(), |error| format!("{error:#}"));
        assert!(have.contains(want), "{to}: have {have}, want {want}");
    }
    let many = SPEC.replace("grid_deg = 60", "grid_deg = 0.25").replace("count = 3", "count = 1000000");
    let have = Spec::parse(&many).unwrap_err().to_string();
    assert!(have.contains("epochs are too many"), "{have}");
    for text in ["", "\u{0}", "name = ", "[[[", "name = 1"] {
        assert!(Spec::parse(text).is_err(), "{text:?}");
    }
}

#[test]
fn shares_are_written_as_k_of_n() {
    assert_eq!(Share::parse("3/16").unwrap(), Share { index: 2, of: 16 });
    assert_eq!(Share::parse("1/1").unwrap(), Share::ALL);
    for text in ["0/4", "5/4", "4", "a/b", "1/0", "-1/4", "1/4/2", ""] {
        let have = Share::parse(text).unwrap_err().to_string();
        assert!(have.contains("write k/n"), "{text}: {have}");
    }
}

/// With the broadcast orbits of a day, a receiver in Esbjerg is protected.
#[test]
fn navigation_files_place_their_satellites() {
    let Some(folder) = shared::path_or_skip("data/esbc") else { return };
    let text = "name = \"n\"\nmasks_deg = [10]\n[places]\npoints = [{ name = \"Esbjerg\", lat_deg = 55.5, lon_deg = 8.5 \
                }]\n[times]\nstart_s = 7200\nstep_s = 3600\ncount = 10\n[[skies]]\nname = \"broadcast\"\nnavigation = \
                [\"ESBC00DNK_R_20201770000_01D_MN.rnx.gz\"]\nsystems = \"GE\"\n[[errors]]\nname = \"ground\"\nuser = \
                \"ground\"\n[judgement]\nmethods = [\"AUTO\"]\n";
    let campaign = Campaign::of(Spec::parse(text).unwrap(), &folder).unwrap();
    let out = tempfile::tempdir().unwrap();
    let table =
        Table::read(&fs::read_to_string(work(&campaign, out.path(), Share::ALL, false)).unwrap()).unwrap();
    assert_eq!(table.rows[0].text("protected"), "10", "{:?}", table.rows[0]);
}
