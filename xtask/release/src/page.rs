//! `rai.html`: the whole page in one file, with its program, which works from a disk.
//!
//! ```text
//! raim-page ─► WebAssembly ─► deflate ─► Base64 ─┐
//! style, scripts, words of README ───────────────┴─► rai.html, with the hashes of its style and its script
//! ```
//!
//! The policy in the file allows its own style, its own script, WebAssembly and the thread that the
//! script starts. It allows no request, so that a promise of the page does not rest on its script.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail, ensure};
use flate2::Compression;
use flate2::write::DeflateEncoder;
use raim::page::{live, report};
use sha2::{Digest as _, Sha256};
use std::io::Write as _;

use super::{Built, VERSION};
use xtask::cargo::root;
use xtask::setup::PAGE_TARGET;

/// Largest size of the file, bytes.
const MOST_BYTES: usize = 1_500_000;

/// Most memory of the program, bytes: 256 MiB.
const MOST_MEMORY: u32 = 256 << 20;

/// Builds the page.
///
/// # Errors
/// If the program does not compile, a part of the page is missing, or the page is too large.
pub(super) fn build(out: &Path) -> Result<Built> {
    if rig::setup::add_target(PAGE_TARGET).is_err() {
        return Ok(Built::Missing(format!("needs the target: rustup target add {PAGE_TARGET}, or --yes")));
    }
    let program = fs::read(compile()?)?;
    let page = html(&program)?;
    ensure!(page.len() <= MOST_BYTES, "the page has {} bytes, more than {MOST_BYTES}", page.len());
    let path = out.join("rai.html");
    fs::write(&path, &page)?;
    println!(
        "           rai.html: {} bytes, of which the program {} before it is packed",
        page.len(),
        program.len()
    );
    Ok(Built::of(vec![path]))
}

/// Compiles the program; returns its file.
fn compile() -> Result<PathBuf> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args([
        "rustc",
        "--quiet",
        "-p",
        "raim-page",
        "--lib",
        "--crate-type",
        "cdylib",
        "--profile",
        "page",
        "--target",
        PAGE_TARGET,
    ]);
    // The paths of this machine do not reach the program, so that it is the same everywhere.
    let home = std::env::var("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|_| std::env::var("HOME").map(|home| Path::new(&home).join(".cargo")));
    let mut flags = vec![
        format!("-Clink-arg=--max-memory={MOST_MEMORY}"),
        // Which every browser of the last three years has.
        "-Ctarget-feature=+simd128".to_owned(),
        format!("--remap-path-prefix={}=rai", root().display()),
    ];
    flags.extend(home.ok().map(|home| format!("--remap-path-prefix={}=cargo", home.display())));
    cargo.env("CARGO_ENCODED_RUSTFLAGS", flags.join("\u{1f}"));
    let status = cargo.current_dir(root()).status().context("cargo cannot be run")?;
    ensure!(status.success(), "the program of the page does not compile");
    let folder = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    Ok(folder.join(PAGE_TARGET).join("page/raim_page.wasm"))
}

/// Returns the page around a program.
fn html(program: &[u8]) -> Result<String> {
    let web = |name: &str| {
        let path = root().join("rai-firmware/page/src/web").join(name);
        fs::read_to_string(&path).with_context(|| path.display().to_string())
    };
    let (clock, thread) = (web("clock.js")?, [web("wasi.js")?, web("clock.js")?, web("worker.js")?].concat());
    let style = [live::style(), report::STYLE.to_owned(), web("page.css")?].concat();
    let script = [report::SCRIPT, live::SCRIPT, &clock, &web("page.js")?].concat();
    let body = web("page.html")?
        .replace("{WORDS}", &words()?)
        .replace("{VERSION}", VERSION)
        .replace("{LIVE}", live::BODY);
    ensure!(!thread.contains("</script"), "the thread ends its own element");
    let policy = format!(
        "default-src 'none'; script-src '{}' 'wasm-unsafe-eval'; style-src '{}'; worker-src blob:; img-src data:; \
         base-uri 'none'; form-action 'none'",
        hash(&script),
        hash(&style)
    );
    Ok(format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<meta name=\"referrer\" content=\"no-referrer\">\n\
         <link rel=\"icon\" href=\"data:,\">\n<title>RAI: is this GNSS position to be trusted?</title>\n\
         <style>{style}</style>\n</head>\n<body>\n{body}\
         <script type=\"text/plain\" id=\"program\">{}</script>\n\
         <script type=\"text/plain\" id=\"thread\">{thread}</script>\n\
         <script>{script}</script>\n</body>\n</html>\n",
        report::base64_text(&packed(program)?)
    ))
}

/// Returns the words of README with their meanings, as a list of definitions.
fn words() -> Result<String> {
    let readme = fs::read_to_string(root().join("README.md"))?;
    let (_, table) = readme.split_once("\n## Words\n").context("README has no part `Words`")?;
    let (table, _) = table.split_once("\n## ").context("README ends within `Words`")?;
    let rows = table.lines().filter(|line| line.starts_with("| ")).skip(1);
    let mut list = String::new();
    for row in rows {
        let [_, word, meaning, _] = row.split('|').map(str::trim).collect::<Vec<_>>()[..] else {
            bail!("a row of `Words` has other columns: {row}")
        };
        let _ = writeln!(list, "<dt>{}</dt><dd>{}</dd>", plain(word), plain(meaning));
    }
    ensure!(list.matches("<dt>").count() > 10, "README explains fewer words than ten");
    Ok(list)
}

/// Returns a cell of README without its marks: **bold**, `code`, *stress*.
fn plain(cell: &str) -> String {
    cell.replace(['*', '`'], "")
}

fn packed(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut packer = DeflateEncoder::new(Vec::new(), Compression::best());
    packer.write_all(bytes)?;
    Ok(packer.finish()?)
}

/// Returns the source of a policy that allows a text.
fn hash(text: &str) -> String {
    format!("sha256-{}", report::base64_text(&Sha256::digest(text.as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn page_names_its_own_parts_and_no_others() {
        let page = html(b"program").unwrap();
        for foreign in [
            "http://",
            "https://",
            " src=",
            "@import",
            "url(",
            "fetch(",
            "XMLHttpRequest",
            "{WORDS}",
            "{LIVE}",
        ] {
            assert!(!page.replace("http://www.w3.org/2000/svg", "").contains(foreign), "{foreign}");
        }
        let between =
            |from: &str, to: &str| page.split_once(from).unwrap().1.split_once(to).unwrap().0.to_owned();
        for text in [between("<style>", "</style>"), between("\n<script>", "</script>")] {
            assert!(page.contains(&hash(&text)));
        }
        assert!(page.contains("<dt>residual; sigma</dt>"));
    }
}
