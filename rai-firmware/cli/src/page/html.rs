//! One self-contained HTML page: words, tables and inline SVG; no link, no font, and a script only
//! in a [report](super::report).

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use anyhow::{Context, Result};

use super::palette;

/// Page that is written from the top.
#[derive(Clone, Debug)]
pub struct Page {
    body: String,
    title: String,
    summary: String,
    /// Level and words of every heading so far.
    headings: Vec<(u8, String)>,
}

/// Number of headings above which a page begins with a list of them.
const CONTENTS: usize = 8;

/// Number of bytes above which a figure is a sentence, in smaller letters.
const SENTENCE: usize = 24;

/// Style of every page.
pub const STYLE: &str = include_str!("page.css");

impl Page {
    /// Returns an empty page with a title and a sentence below it.
    pub fn new(title: &str, summary: &str) -> Self {
        Self { body: String::new(), title: escaped(title), summary: escaped(summary), headings: Vec::new() }
    }

    fn headed(&mut self, level: u8, words: &str) {
        let words = escaped(words);
        let _ = writeln!(self.body, "<h{level} id=\"s{}\">{words}</h{level}>", self.headings.len());
        self.headings.push((level, words));
    }

    /// Adds a heading.
    pub fn heading(&mut self, words: &str) {
        self.headed(2, words);
    }

    /// Adds a heading below a heading.
    pub fn subheading(&mut self, words: &str) {
        self.headed(3, words);
    }

    /// Adds a paragraph.
    pub fn paragraph(&mut self, words: &str) {
        let _ = writeln!(self.body, "<p>{}</p>", escaped(words));
    }

    /// Adds large numbers or whole sentences, each with its name below.
    pub fn figures(&mut self, figures: &[(String, String)]) {
        self.body.push_str("<dl>\n");
        for (name, value) in figures {
            let class = if value.len() > SENTENCE { " class=\"sentence\"" } else { "" };
            let _ = writeln!(
                self.body,
                "<div><dd{class}>{}</dd><dt>{}</dt></div>",
                escaped(value),
                escaped(name)
            );
        }
        self.body.push_str("</dl>\n");
    }

    /// Adds a table; numbers are right-aligned.
    pub fn table(&mut self, columns: &[&str], rows: &[Vec<String>]) {
        let rows: Vec<_> = rows.iter().map(|row| (row.clone(), String::new())).collect();
        self.table_with_notes(columns, &rows);
    }

    /// Adds a table in which a row may have a note, below it over the whole width.
    pub fn table_with_notes(&mut self, columns: &[&str], rows: &[(Vec<String>, String)]) {
        self.body.push_str("<div class=\"wide\"><table>\n<tr>");
        for column in columns {
            let _ = write!(self.body, "<th>{}</th>", escaped(column));
        }
        self.body.push_str("</tr>\n");
        for (row, note) in rows {
            let class = if note.is_empty() { "" } else { " class=\"noted\"" };
            let _ = write!(self.body, "<tr{class}>");
            for cell in row {
                let class = if cell == "–"
                    || cell.trim_start_matches(['-', '+', '−']).starts_with(|c: char| c.is_ascii_digit())
                {
                    " class=\"number\""
                } else {
                    ""
                };
                let _ = write!(self.body, "<td{class}>{}</td>", escaped(cell));
            }
            self.body.push_str("</tr>\n");
            if !note.is_empty() {
                let (span, note) = (columns.len(), escaped(note));
                let _ = writeln!(self.body, "<tr class=\"note\"><td colspan=\"{span}\">{note}</td></tr>");
            }
        }
        self.body.push_str("</table></div>\n");
    }

    /// Adds a picture in SVG.
    pub fn picture(&mut self, svg: &str) {
        self.figure("", svg);
    }

    /// Adds a picture that is drawn for a wide page and for a telephone; the page shows the one
    /// that fits.
    ///
    /// # Errors
    /// The picture cannot be drawn.
    pub fn drawn(&mut self, width_px: u32, draw: impl Fn(u32) -> Result<String>) -> Result<()> {
        self.both(width_px, draw)
    }

    /// Adds such pictures side by side, if the page is wide enough.
    ///
    /// # Errors
    /// A picture cannot be drawn.
    pub fn drawn_beside(&mut self, width_px: u32, draw: &[&dyn Fn(u32) -> Result<String>]) -> Result<()> {
        self.body.push_str("<div class=\"row\">\n");
        for draw in draw {
            self.both(width_px, draw)?;
        }
        self.body.push_str("</div>\n");
        Ok(())
    }

    /// Adds a picture for a wide page, and another for a telephone.
    fn both(&mut self, width_px: u32, draw: impl Fn(u32) -> Result<String>) -> Result<()> {
        for (class, width_px) in [("wide-page", width_px), ("narrow-page", TELEPHONE_PX)] {
            self.figure(&format!(" class=\"{class}\""), &draw(width_px)?);
        }
        Ok(())
    }

    /// Adds a picture. It is copied once, because pictures are most of the page.
    fn figure(&mut self, class: &str, svg: &str) {
        let parts = scalable(svg);
        self.body.reserve(svg.len() + class.len() + 200);
        let _ = writeln!(self.body, "<figure{class}>{}{}{}</figure>", parts.0, parts.1, parts.2);
    }

    /// Adds HTML as it is.
    pub(super) fn raw(&mut self, html: &str) {
        self.body.push_str(html);
    }

    /// Adds pictures side by side, if the page is wide enough.
    pub fn pictures(&mut self, svgs: &[String]) {
        self.body.push_str("<div class=\"row\">\n");
        for svg in svgs {
            self.picture(svg);
        }
        self.body.push_str("</div>\n");
    }

    /// Returns a folded list of the headings, if there are many.
    fn contents(&self) -> String {
        let mut list = String::new();
        if self.headings.len() > CONTENTS {
            let _ = writeln!(list, "<details><summary>Contents: {} parts</summary><ul>", self.headings.len());
            for (index, (level, words)) in self.headings.iter().enumerate() {
                let _ = writeln!(list, "<li class=\"h{level}\"><a href=\"#s{index}\">{words}</a></li>");
            }
            list.push_str("</ul></details>\n");
        }
        list
    }

    /// Returns the whole page.
    pub fn html(&self) -> String {
        [self.head().as_str(), &self.body, TAIL].concat()
    }

    /// Returns everything before the body.
    fn head(&self) -> String {
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n<title>{0}</title>\n<style>\n{3}{STYLE}</style>\n\
             </head>\n<body>\n<main>\n<h1>{0}</h1>\n<p class=\"lead\">{1}</p>\n{2}",
            self.title,
            self.summary,
            self.contents(),
            palette::style(),
        )
    }

    /// Writes the page, and makes its folder.
    ///
    /// # Errors
    /// The folder or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        replace(path, |file| {
            [self.head().as_str(), &self.body, TAIL]
                .iter()
                .try_for_each(|part| file.write_all(part.as_bytes()))
        })
    }

    /// Writes the page, with more HTML at its end. The page is gone before that HTML is made, so
    /// that both are never in memory together.
    ///
    /// # Errors
    /// The folder or the file cannot be written.
    pub(super) fn write_with(
        self,
        path: &Path,
        more: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<()> {
        replace(path, |file| {
            file.write_all(self.head().as_bytes())?;
            file.write_all(self.body.as_bytes())?;
            drop(self);
            more(file)?;
            file.write_all(TAIL.as_bytes())
        })
    }
}

/// Width of a picture on a telephone, pixels: 390 without the margins of page and picture.
pub const TELEPHONE_PX: u32 = 346;

/// End of every page.
const TAIL: &str = "</main>\n</body>\n</html>\n";

/// Writes a file, and makes its folder.
///
/// # Errors
/// The folder or the file cannot be written.
pub fn write_file(path: &Path, text: &str) -> Result<()> {
    replace(path, |file| file.write_all(text.as_bytes()))
}

/// Replaces a file in one step, so that a reader finds the old one or the new one: writes beside it
/// and renames. Makes its folder.
fn replace(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    let mut beside = path.as_os_str().to_owned();
    beside.push(".new");
    let written = File::create(&beside).and_then(|file| {
        let mut file = BufWriter::new(file);
        write(&mut file)?;
        file.flush()?;
        std::fs::rename(&beside, path)
    });
    if written.is_err() {
        // Half a page is of no use, and may be what fills the disk.
        let _ = std::fs::remove_file(&beside);
    }
    written.with_context(|| format!("cannot write {}", path.display()))
}

/// Returns the text escaped for HTML.
pub(super) fn escaped(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Lets a picture shrink with the page: its size in pixels becomes its largest size. It shrinks to
/// four fifths and no further, so that its words stay legible; a narrower page scrolls it. Returns
/// the parts of the picture, of which the middle one replaces the size.
fn scalable(svg: &str) -> (&str, String, &str) {
    let size = |name: &str| {
        let (_, rest) = svg.split_once(&format!("{name}=\""))?;
        rest.split_once('"').map(|(size, _)| size)
    };
    let (width, height) = (size("width").unwrap_or(""), size("height").unwrap_or(""));
    match svg.split_once(&format!("width=\"{width}\" height=\"{height}\"")) {
        Some((before, after)) => {
            let least = width.parse::<u32>().unwrap_or(0) * 4 / 5;
            let style = format!("style=\"width:100%;max-width:{width}px;min-width:{least}px;height:auto\"");
            (before, style, after)
        }
        None => (svg, String::new(), ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_markup_stay_words() {
        let mut page = Page::new("a < b", "\"quoted\" & more");
        page.table(&["<script>"], &[vec!["-1.5".to_owned(), "<b>".to_owned()]]);
        let have = page.html();
        for want in
            ["<h1>a &lt; b</h1>", "&quot;quoted&quot; &amp; more", "&lt;script&gt;", "<td>&lt;b&gt;</td>"]
        {
            assert!(have.contains(want), "want {want} in {have}");
        }
        assert!(have.contains("<td class=\"number\">-1.5</td>"), "{have}");
    }

    #[test]
    fn page_needs_nothing_from_elsewhere() {
        let html = Page::new("t", "s").html();
        for foreign in ["http://", "https://", "<script", "<link", "@import", "url("] {
            assert!(!html.contains(foreign), "{foreign}");
        }
    }

    #[test]
    fn a_long_page_begins_with_its_contents_and_a_short_one_does_not() {
        let mut page = Page::new("t", "s");
        for part in 0..=CONTENTS {
            page.heading(&format!("part <{part}>"));
        }
        let html = page.html();
        assert!(html.contains("<a href=\"#s8\">part &lt;8&gt;</a>"), "{html}");
        assert!(html.contains("<h2 id=\"s8\">part &lt;8&gt;</h2>"), "{html}");
        let mut short = Page::new("t", "s");
        short.heading("one");
        assert!(!short.html().contains("<details>"));
    }

    #[test]
    fn a_note_stands_below_its_row_over_the_whole_table() {
        let mut page = Page::new("t", "s");
        page.table_with_notes(&["a", "b"], &[(vec!["1".into(), "2".into()], "why <so>".into())]);
        assert!(page.html().contains("<td colspan=\"2\">why &lt;so&gt;</td>"), "{}", page.html());
    }

    #[test]
    fn picture_scales_with_the_page() {
        let have = scalable("<svg width=\"640\" height=\"520\" viewBox=\"0 0 640 520\"></svg>");
        let want = "<svg style=\"width:100%;max-width:640px;min-width:512px;height:auto\" viewBox=\"0 0 640 520\"></svg>";
        assert_eq!([have.0, &have.1, have.2].concat(), want);
    }
}
