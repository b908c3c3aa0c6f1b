//! The page as one HTML document: structure, style and script in one file that asks the network for nothing.

use std::fmt::Write;

use crate::escape;
use crate::figure::Figure;
use crate::page::{Block, Page, Section, Tone};

/// The style; colours follow the reader's choice of light or dark.
const STYLE: &str = include_str!("style.css");
/// Zoom, pan and reading of values. The page is complete without it.
const SCRIPT: &str = include_str!("view.js");

impl Page {
    /// The page as one HTML document that needs nothing else. Its policy forbids every request.
    pub fn to_html(&self) -> String {
        let title = escape::text(&self.title);
        let mut html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; \
             script-src 'unsafe-inline'; img-src data:\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n\
             </head>\n<body>\n<header>\n<h1>{title}</h1>\n"
        );
        let (class, sign, word) = match self.verdict.tone {
            Tone::Good => ("good", "✓", "all well"),
            Tone::Found => ("found", "◆", "found"),
            Tone::Attention => ("attention", "!", "attention"),
        };
        let _ = writeln!(
            html,
            "<div class=\"verdict {class}\"><span class=\"sign\" role=\"img\" aria-label=\"{word}\">{sign}</span>\
             <div><p class=\"headline\">{}</p>",
            escape::text(&self.verdict.headline)
        );
        list(&mut html, &self.verdict.sentences);
        html.push_str("</div></div>\n<nav aria-label=\"sections\"><ul>");
        let titles = self.sections.iter().map(|s| s.title.as_str()).chain(["How it was computed"]);
        for (k, title) in titles.enumerate() {
            let _ = write!(html, "<li><a href=\"#section-{k}\">{}</a></li>", escape::text(title));
        }
        html.push_str("</ul></nav>\n</header>\n<main>\n");
        for (k, part) in self.sections.iter().enumerate() {
            section(&mut html, k, part);
        }
        let _ = write!(
            html,
            "<section id=\"section-{}\"><h2>How it was computed</h2>\n<dl>\n",
            self.sections.len()
        );
        for (name, value) in &self.provenance {
            let _ = writeln!(html, "<dt>{}</dt><dd>{}</dd>", escape::text(name), escape::text(value));
        }
        let _ = write!(
            html,
            "</dl>\n</section>\n</main>\n<script type=\"application/json\" id=\"results\">{}</script>\n\
             <script>\n{SCRIPT}</script>\n</body>\n</html>\n",
            escape::json(&self.results_json)
        );
        html
    }
}

fn section(html: &mut String, number: usize, section: &Section) {
    let title = escape::text(&section.title);
    let _ = writeln!(html, "<section id=\"section-{number}\"><h2>{title}</h2>");
    if !section.introduction.is_empty() {
        let _ = writeln!(html, "<p>{}</p>", escape::text(&section.introduction));
    }
    section.blocks.iter().for_each(|b| block(html, b));
    html.push_str("</section>\n");
}

fn block(html: &mut String, shown: &Block) {
    match shown {
        Block::Text(text) => {
            let _ = writeln!(html, "<p>{}</p>", escape::text(text));
        }
        Block::List(sentences) => list(html, sentences),
        Block::Code(code) => {
            let _ = writeln!(html, "<pre class=\"scroll\" tabindex=\"0\">{}</pre>", escape::text(code));
        }
        Block::Table(table) => html.push_str(&table.to_html()),
        Block::Figure(figure) => html.push_str(&figure.to_html()),
        Block::Figures(figures) => {
            let wide = if figures.iter().any(Figure::is_wide) { " wide" } else { "" };
            let _ = writeln!(html, "<div class=\"figures{wide}\">");
            figures.iter().for_each(|f| html.push_str(&f.to_html()));
            html.push_str("</div>\n");
        }
        Block::Folded { title, open, blocks } => {
            let open = if *open { " open" } else { "" };
            let _ = writeln!(html, "<details{open}><summary>{}</summary>", escape::text(title));
            blocks.iter().for_each(|b| block(html, b));
            html.push_str("</details>\n");
        }
    }
}

fn list(html: &mut String, sentences: &[String]) {
    if sentences.is_empty() {
        return;
    }
    html.push_str("<ul>");
    for sentence in sentences {
        let _ = write!(html, "<li>{}</li>", escape::text(sentence));
    }
    html.push_str("</ul>\n");
}
