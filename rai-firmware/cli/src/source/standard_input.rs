//! A file in place of standard input.
//!
//! `rai run --input FILE` is `rai run < FILE`: what is done with a file on standard input is then
//! done with a named one.

use std::path::Path;

use anyhow::{Context as _, Result, ensure};

use super::{FORM, Source};

/// Returns the source of a service. A file takes the place of standard input.
///
/// # Errors
/// There is no such file, or it cannot be read.
pub(crate) fn in_place_of(source: Source) -> Result<Source> {
    let Source::File(path) = &source else { return Ok(source) };
    let about =
        std::fs::metadata(path).with_context(|| format!("{} cannot be read; {FORM}", path.display()))?;
    ensure!(about.is_file(), "{FORM}, and `{}` is none", path.display());
    replace(path).with_context(|| path.display().to_string())?;
    Ok(Source::Standard)
}

#[cfg(unix)]
fn replace(path: &Path) -> Result<()> {
    nix::unistd::dup2_stdin(std::fs::File::open(path)?)?;
    Ok(())
}

#[cfg(not(unix))]
fn replace(_: &Path) -> Result<()> {
    anyhow::bail!("on this system give a file as standard input: rai run < FILE")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_that_is_not_there_is_named_with_the_forms_of_an_input() {
        let error = in_place_of(Source::File("no-such-file.ubx".into())).unwrap_err();
        let reported = format!("{error:#}");
        assert!(
            reported.starts_with("no-such-file.ubx cannot be read; an input is serial:PORT@BAUD"),
            "{reported}"
        );
        // The words of the system.
        assert!(reported.contains("(os error 2)"), "{reported}");
    }
}
