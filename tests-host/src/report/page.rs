//! One self-contained HTML page: words, tables and inline SVG; no script, no link, no font.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, Result};

/// A page that is written from the top.
#[derive(Clone, Debug)]
pub struct Page {
    body: String,
    title: String,
}

const STYLE: &str = include_str!("page.css");

impl Page {
    /// An empty page with a title and a sentence below it.
    pub fn new(title: &str, summary: &str) -> Self {
        let mut page = Self { body: String::new(), title: escaped(title) };
        let _ = write!(page.body, "<h1>{}</h1>\n<p class=\"lead\">{}</p>\n", page.title, escaped(summary));
        page
    }

    /// A heading.
    pub fn heading(&mut self, words: &str) {
        let _ = writeln!(self.body, "<h2>{}</h2>", escaped(words));
    }

    /// A heading below a heading.
    pub fn subheading(&mut self, words: &str) {
        let _ = writeln!(self.body, "<h3>{}</h3>", escaped(words));
    }

    /// A paragraph.
    pub fn paragraph(&mut self, words: &str) {
        let _ = writeln!(self.body, "<p>{}</p>", escaped(words));
    }

    /// Numbers that are to be seen at once: each with its name below.
    pub fn figures(&mut self, figures: &[(String, String)]) {
        self.body.push_str("<dl>\n");
        for (name, value) in figures {
            let _ = writeln!(self.body, "<div><dd>{}</dd><dt>{}</dt></div>", escaped(value), escaped(name));
        }
        self.body.push_str("</dl>\n");
    }

    /// A table; numbers stand right.
    pub fn table(&mut self, columns: &[&str], rows: &[Vec<String>]) {
        self.body.push_str("<div class=\"wide\"><table>\n<tr>");
        for column in columns {
            let _ = write!(self.body, "<th>{}</th>", escaped(column));
        }
        self.body.push_str("</tr>\n");
        for row in rows {
            self.body.push_str("<tr>");
            for cell in row {
                let class =
                    if cell.trim_start_matches(['-', '+', '−']).starts_with(|c: char| c.is_ascii_digit()) {
                        " class=\"number\""
                    } else {
                        ""
                    };
                let _ = write!(self.body, "<td{class}>{}</td>", escaped(cell));
            }
            self.body.push_str("</tr>\n");
        }
        self.body.push_str("</table></div>\n");
    }

    /// A picture in SVG.
    pub fn picture(&mut self, svg: &str) {
        let _ = writeln!(self.body, "<figure>{}</figure>", scalable(svg));
    }

    /// Pictures beside each other where the page is wide enough.
    pub fn pictures(&mut self, svgs: &[String]) {
        self.body.push_str("<div class=\"row\">\n");
        for svg in svgs {
            self.picture(svg);
        }
        self.body.push_str("</div>\n");
    }

    /// The whole page.
    pub fn html(&self) -> String {
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n<title>{}</title>\n<style>\n{STYLE}</style>\n\
             </head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
            self.title, self.body
        )
    }

    /// Writes the page, and the folder it is to be in.
    ///
    /// # Errors
    /// What could not be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        write_file(path, &self.html())
    }
}

/// Writes a file, and the folder it is to be in.
///
/// # Errors
/// What could not be written.
pub fn write_file(path: &Path, text: &str) -> Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

/// Text that HTML takes as text.
fn escaped(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Lets a picture shrink with the page: its size in pixels becomes the most it takes.
fn scalable(svg: &str) -> String {
    let size = |name: &str| {
        let (_, rest) = svg.split_once(&format!("{name}=\""))?;
        rest.split_once('"').map(|(size, _)| size)
    };
    match (size("width"), size("height")) {
        (Some(width), Some(height)) => svg.replacen(
            &format!("width=\"{width}\" height=\"{height}\""),
            &format!("style=\"width:100%;max-width:{width}px;height:auto\""),
            1,
        ),
        _ => svg.to_owned(),
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
    fn picture_scales_with_the_page() {
        let have = scalable("<svg width=\"640\" height=\"520\" viewBox=\"0 0 640 520\"></svg>");
        let want = "<svg style=\"width:100%;max-width:640px;height:auto\" viewBox=\"0 0 640 520\"></svg>";
        assert_eq!(have, want);
    }
}
