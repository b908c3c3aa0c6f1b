//! `aurt new-plugin`: a friction model of one's own to start from.

use std::path::PathBuf;

use aurt_experiment::workbench::failure::Failure;
use aurt_plugins::{PluginLanguage, new_plugin};
use clap::Args;
use serde_json::json;

use super::Session;
use crate::rendering::terminal::Report;
use crate::values::{Choice, choice};

/// Write a plugin with a model to start from.
///
/// A Rust crate, usable linked or as a library, or a C file. It builds, tests itself, and its model can be named
/// in experiments at once.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  aurt new-plugin my-friction\n  aurt new-plugin my-friction --lang c --path plugins/mine"
)]
pub struct NewPlugin {
    /// Name of the plugin: lower-case letters, digits, - and _
    #[arg(value_name = "NAME")]
    name: String,
    /// Language of the plugin
    #[arg(long, value_parser = choice(LANGUAGES), default_value = "rust")]
    lang: PluginLanguage,
    /// Folder to write; by default the name, here
    #[arg(long, value_name = "DIR")]
    path: Option<PathBuf>,
}

const LANGUAGES: &[Choice<PluginLanguage>] = &[
    ("rust", "A crate, linked statically or built as a library", PluginLanguage::Rust),
    ("c", "A file, built as a library", PluginLanguage::C),
];

impl NewPlugin {
    pub fn run(&self, _: &Session<'_>) -> Result<Report, Failure> {
        let folder = self.path.clone().unwrap_or_else(|| PathBuf::from(&self.name));
        let plugin = new_plugin(&self.name, self.lang, &folder)?;
        let library = plugin.folder.join(&plugin.library);
        let mut text = format!("plugin with the model `{}` in {}\n", plugin.model, plugin.folder.display());
        text.extend(plugin.files.iter().map(|f| format!("  {}\n", f.display())));
        text.push_str(&format!("\nnext\n  cd {}\n", plugin.folder.display()));
        text.extend(plugin.commands.iter().map(|c| format!("  {c}\n")));
        text.push_str(&format!("  aurt --plugin {} models\n", plugin.library.display()));
        let json = json!({
            "command": "new-plugin",
            "folder": plugin.folder,
            "files": plugin.files,
            "model": plugin.model,
            "library": library,
            "commands": plugin.commands,
        });
        Ok(Report { text, json, findings: false })
    }
}
