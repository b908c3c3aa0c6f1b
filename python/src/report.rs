//! Reports in notebooks and files.

use std::path::PathBuf;

use aurt_experiment::workbench::output::OutputFile;
use aurt_report::Page;
use pyo3::prelude::*;

use crate::error::raised;

/// A report: one self-contained HTML page that shows itself in a notebook.
#[pyclass(frozen, module = "aurt")]
#[derive(Clone)]
pub struct Report {
    /// The page.
    #[pyo3(get)]
    html: String,
    /// What it is about.
    #[pyo3(get)]
    title: String,
}

impl Report {
    pub fn of(page: &Page) -> Self {
        Self::new(page.to_html(), page.title.clone())
    }

    pub const fn new(html: String, title: String) -> Self {
        Self { html, title }
    }

    /// Page and title.
    pub fn parts(&self) -> [&str; 2] {
        [&self.html, &self.title]
    }

    /// The page in a frame of its own, so that its styles stay within it.
    pub fn notebook(&self) -> String {
        let page = self.html.replace('&', "&amp;").replace('"', "&quot;");
        format!(
            "<iframe srcdoc=\"{page}\" style=\"width: 100%; height: 40em; border: 1px solid #ccc\" \
             sandbox=\"allow-scripts allow-downloads\"></iframe>"
        )
    }
}

#[pymethods]
impl Report {
    /// Writes the page into a file, which appears whole or not at all.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        let file = OutputFile::new("path", &path, &[]).map_err(raised)?;
        file.write(self.html.as_bytes()).map_err(raised)
    }

    fn _repr_html_(&self) -> String {
        self.notebook()
    }

    fn __repr__(&self) -> String {
        format!("<aurt.Report: {}>", self.title)
    }
}
