//! Specification of a campaign: a TOML file, checked once.
//!
//! ```toml
//! name = "lpv200"
//! seed = 1
//! masks_deg = [5]
//! [places]
//! grid_deg = 10
//! [times]
//! step_s = 600
//! count = 144
//! [[skies]]
//! name = "GPS and Galileo"
//! fleets = ["gps31", "galileo24"]
//! [[errors]]
//! name = "airborne"
//! user = "airborne"
//! [judgement]
//! set = ["PHASE,LPV200", "ISM,RESEARCH"]
//! methods = ["SEPARATION", "AUTO"]
//! ```
//!
//! Every field has a range. An error names the field and the accepted values.

use std::path::Path;

use anyhow::{Context as _, Result, bail, ensure};
use serde::Deserialize;

/// A whole specification.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    /// Name of the campaign and of its files.
    pub name: String,
    /// Seed of all random choices.
    #[serde(default)]
    pub seed: u64,
    /// Ratio of the drawn noise to the expected sigma; 0 shows the effect of the geometry alone.
    #[serde(default)]
    pub noise: f64,
    /// Elevation masks, degrees.
    pub masks_deg: Vec<f64>,
    /// Places of the antenna.
    pub places: PlacesSpec,
    /// Instants of the campaign.
    pub times: TimesSpec,
    /// Satellite skies.
    pub skies: Vec<SkySpec>,
    /// Error models of the ranges.
    pub errors: Vec<ErrorSpec>,
    /// Faults; none unless given.
    #[serde(default = "nothing_wrong")]
    pub faults: Vec<FaultSpec>,
    /// Methods and settings that judge the epochs.
    pub judgement: JudgementSpec,
}

/// Places: one of grid, points and track.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlacesSpec {
    /// A grid over the globe with this step, degrees.
    pub grid_deg: Option<f64>,
    /// Named points.
    pub points: Option<Vec<PointSpec>>,
    /// A CSV file with the columns `time_s,lat_deg,lon_deg,height_m`.
    pub track: Option<String>,
    /// Height of the grid, m.
    #[serde(default)]
    pub height_m: f64,
}

/// A named point.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointSpec {
    /// Name in tables.
    pub name: String,
    /// Geodetic latitude, degrees.
    pub lat_deg: f64,
    /// Longitude, degrees.
    pub lon_deg: f64,
    /// Height above the ellipsoid, m.
    #[serde(default)]
    pub height_m: f64,
}

/// Instants, counted from the start of the sky.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimesSpec {
    /// First instant, s.
    #[serde(default)]
    pub start_s: f64,
    /// Time between instants, s.
    pub step_s: f64,
    /// Number of instants.
    pub count: u32,
}

/// Satellites of several systems together.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkySpec {
    /// Name in tables.
    pub name: String,
    /// Names of built-in constellations.
    #[serde(default)]
    pub fleets: Vec<String>,
    /// YUMA almanacs.
    #[serde(default)]
    pub almanacs: Vec<AlmanacSpec>,
    /// RINEX navigation files.
    #[serde(default)]
    pub navigation: Vec<String>,
    /// Letters of the systems to take from the navigation files.
    pub systems: Option<String>,
}

/// An almanac, with its system, which the file does not name.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AlmanacSpec {
    /// Path of the file.
    pub file: String,
    /// Letter of the system: G, E, C, R.
    pub system: String,
}

/// Error model: the user's part of the module's model, or a sigma that is the same for all methods.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorSpec {
    /// Name in tables.
    pub name: String,
    /// `ground` or `airborne`: the module's own error model, as each method uses it.
    pub user: Option<String>,
    /// The same sigma in every direction, m.
    pub sigma_m: Option<f64>,
    /// A sigma that grows with the cosecant of the elevation, m at the zenith.
    pub zenith_m: Option<f64>,
}

/// Fault of an epoch.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum FaultSpec {
    /// No fault.
    None,
    /// One satellite of each epoch, drawn with its bias.
    Drawn {
        /// Smallest and largest bias, m; the sign is random.
        bias_m: [f64; 2],
    },
    /// Each satellite of each epoch in turn.
    EverySatellite {
        /// Bias, m.
        bias_m: f64,
    },
    /// Each constellation of each epoch in turn, shifted as one.
    Constellation {
        /// Shift to the east, north and up, m.
        shift_m: [f64; 3],
    },
}

impl FaultSpec {
    /// Returns the name in tables.
    pub fn name(&self) -> String {
        match self {
            Self::None => "none".to_owned(),
            Self::Drawn { bias_m: [least, largest] } => format!("drawn {least} to {largest} m"),
            Self::EverySatellite { bias_m } => format!("every satellite {bias_m} m"),
            Self::Constellation { shift_m: [east, north, up] } => {
                format!("constellation {east} {north} {up} m")
            }
        }
    }
}

/// Methods, policies and levels, all combined, under the same commands.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgementSpec {
    /// Commands of the module for all of them, such as `PHASE,LPV200`.
    #[serde(default)]
    pub set: Vec<String>,
    /// Values of `METHOD`.
    pub methods: Vec<String>,
    /// Values of `POLICY`; ignored for `SEPARATION`.
    #[serde(default = "first_policy")]
    pub policies: Vec<String>,
    /// Values of `LEVELS`; ignored for `SEPARATION`.
    #[serde(default = "first_levels")]
    pub levels: Vec<String>,
}

fn nothing_wrong() -> Vec<FaultSpec> {
    vec![FaultSpec::None]
}

fn first_policy() -> Vec<String> {
    vec!["T1".to_owned()]
}

fn first_levels() -> Vec<String> {
    vec!["BOUND".to_owned()]
}

/// Largest number of epochs of a campaign: some weeks on one core.
const MOST_EPOCHS: u64 = 20_000_000_000;

impl Spec {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// If something in it is wrong; the error names the place and the expected form.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| {
            format!("cannot read {}; tests-host/campaigns/lpv200.toml is an example", path.display())
        })?;
        Self::parse(&text).with_context(|| path.display().to_string())
    }

    /// Reads and checks a text.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(text: &str) -> Result<Self> {
        let spec: Self = toml::from_str(text)?;
        spec.check()?;
        Ok(spec)
    }

    /// Returns everything that the columns of a table do not have, in one line.
    pub fn words(&self) -> String {
        let list = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
        let places = match (&self.places.grid_deg, &self.places.points, &self.places.track) {
            (Some(step_deg), ..) => format!("a grid of {step_deg}° at {} m", self.places.height_m),
            (_, Some(points), _) => format!("{} points", points.len()),
            (.., track) => format!("the track {}", track.as_deref().unwrap_or("")),
        };
        let TimesSpec { start_s, step_s, count } = &self.times;
        let skies = self.skies.iter().map(SkySpec::words).collect::<Vec<_>>().join(" | ");
        let errors = self.errors.iter().map(ErrorSpec::words).collect::<Vec<_>>().join(" | ");
        let set = self.judgement.set.join(" ");
        format!(
            "masks: elevation {}°; places: {places}; times: from {start_s} s, every {step_s} s, {count} in all; \
             skies: {skies}; errors: {errors}; set: {}",
            list(&self.masks_deg),
            if set.is_empty() { "as at start" } else { &set }
        )
    }

    fn check(&self) -> Result<()> {
        ensure!(
            !self.name.is_empty() && self.name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c)),
            "name = \"{}\": write letters, digits, - and _, because it names files",
            self.name
        );
        within("noise", self.noise, 0.0, 100.0)?;
        some("masks_deg", &self.masks_deg, "masks_deg = [5]")?;
        self.masks_deg.iter().try_for_each(|&mask| within("masks_deg", mask, 0.0, 60.0))?;
        self.places.check()?;
        within("times.start_s", self.times.start_s, 0.0, 1e9)?;
        within("times.step_s", self.times.step_s, 1e-3, 1e7)?;
        ensure!((1..=1_000_000).contains(&self.times.count), "times.count: write 1 to 1000000");
        some("skies", &self.skies, "[[skies]] with a name and fleets")?;
        self.skies.iter().try_for_each(SkySpec::check)?;
        some("errors", &self.errors, "[[errors]] with a name and user = \"ground\"")?;
        self.errors.iter().try_for_each(ErrorSpec::check)?;
        distinct("skies", self.skies.iter().map(|sky| sky.name.as_str()))?;
        distinct("errors", self.errors.iter().map(|errors| errors.name.as_str()))?;
        some("faults", &self.faults, "faults = [{ kind = \"none\" }], or omit it")?;
        self.faults.iter().try_for_each(check_fault)?;
        some("judgement.methods", &self.judgement.methods, "methods = [\"SEPARATION\"]")?;
        some("judgement.policies", &self.judgement.policies, "policies = [\"T1\"], or omit it")?;
        some("judgement.levels", &self.judgement.levels, "levels = [\"BOUND\"], or omit it")?;
        let places = self.places.grid_deg.map_or(1.0, |step| 65_000.0 / (step * step)) as u64;
        let cases = self.skies.len() * self.masks_deg.len() * self.errors.len() * self.faults.len();
        let epochs = places.max(1) * u64::from(self.times.count) * cases as u64;
        ensure!(epochs <= MOST_EPOCHS, "{epochs} epochs are too many: choose a wider grid or fewer instants");
        Ok(())
    }
}

impl PlacesSpec {
    fn check(&self) -> Result<()> {
        let given = [self.grid_deg.is_some(), self.points.is_some(), self.track.is_some()];
        ensure!(
            given.into_iter().filter(|&is_given| is_given).count() == 1,
            "places: write one of grid_deg = 10, points = [{{ name = \"home\", lat_deg = 48, lon_deg = 11 }}] and \
             track = \"flight.csv\""
        );
        within("places.height_m", self.height_m, -1e3, 2e5)?;
        if let Some(step_deg) = self.grid_deg {
            within("places.grid_deg", step_deg, 0.25, 90.0)?;
            ensure!(
                (180.0 / step_deg).fract().abs() < 1e-9,
                "places.grid_deg = {step_deg}: write a step that divides 180, such as 10, 5 or 2.5"
            );
        }
        let points = self.points.as_deref().unwrap_or_default();
        ensure!(self.points.is_none() || !points.is_empty(), "places.points: write at least one point");
        for point in points {
            word("places.points.name", &point.name)?;
            within("places.points.lat_deg", point.lat_deg, -90.0, 90.0)?;
            within("places.points.lon_deg", point.lon_deg, -360.0, 360.0)?;
            within("places.points.height_m", point.height_m, -1e3, 2e5)?;
        }
        distinct("places.points", points.iter().map(|point| point.name.as_str()))
    }
}

impl SkySpec {
    fn words(&self) -> String {
        let almanacs = self.almanacs.iter().map(|almanac| format!("{} of {}", almanac.file, almanac.system));
        let sources = self.fleets.iter().chain(&self.navigation).cloned().chain(almanacs);
        format!("{} ({})", self.name, sources.collect::<Vec<_>>().join(" "))
    }

    fn check(&self) -> Result<()> {
        word("skies.name", &self.name)?;
        ensure!(
            !(self.fleets.is_empty() && self.almanacs.is_empty() && self.navigation.is_empty()),
            "sky \"{}\" has no satellites: write fleets = [\"gps31\", \"galileo24\"], almanacs or navigation",
            self.name
        );
        ensure!(
            self.navigation.is_empty() || (self.fleets.is_empty() && self.almanacs.is_empty()),
            "sky \"{}\": navigation files have their own time, so they cannot be combined",
            self.name
        );
        Ok(())
    }
}

impl ErrorSpec {
    fn words(&self) -> String {
        match (&self.user, self.sigma_m, self.zenith_m) {
            (Some(user), ..) => format!("{} (the module's model for an antenna: {user})", self.name),
            (_, Some(sigma_m), _) => format!("{} (sigma {sigma_m} m)", self.name),
            (.., zenith_m) => format!("{} (sigma {} m at the zenith)", self.name, zenith_m.unwrap_or(0.0)),
        }
    }

    fn check(&self) -> Result<()> {
        word("errors.name", &self.name)?;
        let given = [self.user.is_some(), self.sigma_m.is_some(), self.zenith_m.is_some()];
        ensure!(
            given.into_iter().filter(|&is_given| is_given).count() == 1,
            "errors \"{}\": write one of user = \"ground\", sigma_m = 3 and zenith_m = 1.5",
            self.name
        );
        if let Some(user) = &self.user {
            ensure!(
                ["ground", "airborne"].contains(&user.as_str()),
                "errors.user = \"{user}\": write \"ground\" or \"airborne\""
            );
        }
        self.sigma_m.into_iter().try_for_each(|sigma_m| within("errors.sigma_m", sigma_m, 0.01, 1e3))?;
        self.zenith_m.into_iter().try_for_each(|zenith_m| within("errors.zenith_m", zenith_m, 0.01, 1e3))
    }
}

fn check_fault(fault: &FaultSpec) -> Result<()> {
    let metres = |metres: f64| within("faults", metres, -1e6, 1e6);
    match fault {
        FaultSpec::None => Ok(()),
        FaultSpec::Drawn { bias_m: [least, largest] } => {
            ensure!(
                0.0 <= *least && least < largest,
                "faults: bias_m of `drawn` is [least, largest], both positive"
            );
            metres(*largest)
        }
        FaultSpec::EverySatellite { bias_m } => metres(*bias_m),
        FaultSpec::Constellation { shift_m } => shift_m.iter().try_for_each(|&part| metres(part)),
    }
}

/// Checks that a number is within its range. NaN is not.
fn within(field: &str, value: f64, least: f64, largest: f64) -> Result<()> {
    ensure!(
        (least..=largest).contains(&value),
        "{field} = {value}: write a number from {least} to {largest}"
    );
    Ok(())
}

fn some<T>(field: &str, list: &[T], example: &str) -> Result<()> {
    ensure!(!list.is_empty(), "{field} is empty: write {example}");
    Ok(())
}

/// Checks that a cell of a table can hold a name.
fn word(field: &str, name: &str) -> Result<()> {
    let is_plain = |c: char| !c.is_control() && !",\"".contains(c);
    ensure!(
        !name.trim().is_empty() && name.len() <= 60 && name.chars().all(is_plain),
        "{field} = {name:?}: write 1 to 60 characters without commas and quotes"
    );
    Ok(())
}

fn distinct<'n>(field: &str, names: impl Iterator<Item = &'n str>) -> Result<()> {
    let mut known = std::collections::BTreeSet::new();
    for name in names {
        if !known.insert(name) {
            bail!("{field}: the name \"{name}\" occurs twice; give each its own");
        }
    }
    Ok(())
}
