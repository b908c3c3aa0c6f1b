//! Sources that every unit has, its token, and the archive.

use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::{FMI, Kind};
use crate::{ExportError, Source};

/// The sources around the model's own, by their names.
pub(super) fn layer(kind: Kind) -> Vec<(String, String)> {
    let files = [
        ("component.h", include_str!("sources/component.h")),
        ("component.c", include_str!("sources/component.c")),
        match kind {
            Kind::Inverse => ("inverse.c", include_str!("sources/inverse.c")),
            Kind::Forward => ("forward.c", include_str!("sources/forward.c")),
        },
        ("fmi2.h", include_str!("sources/fmi2.h")),
        ("fmi2.c", include_str!("sources/fmi2.c")),
    ];
    files.into_iter().map(|(name, text)| (name.to_owned(), text.to_owned())).collect()
}

/// The token by which description and library know each other: a hash of the model and of all sources, in the form of a
/// GUID.
pub(super) fn token(source: &Source<'_>, kind: Kind, sources: &[(String, String)]) -> String {
    let mut hash = blake3::Hasher::new();
    for word in [source.provenance.blake3.as_str(), kind.name(), FMI] {
        hash.update(word.as_bytes());
        hash.update(&[0]);
    }
    for (name, text) in sources {
        hash.update(name.as_bytes());
        hash.update(&[0]);
        hash.update(text.as_bytes());
        hash.update(&[0]);
    }
    let hex = hash.finalize().to_hex();
    format!("{{{}-{}-{}-{}-{}}}", &hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..32])
}

pub(super) fn zipped(files: &[(String, Vec<u8>)]) -> Result<Vec<u8>, ExportError> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, contents) in files {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(zip::DateTime::default())
            .unix_permissions(if name.ends_with(".so") { 0o755 } else { 0o644 });
        archive.start_file(name.as_str(), options)?;
        archive.write_all(contents).map_err(zip::result::ZipError::from)?;
    }
    Ok(archive.finish()?.into_inner())
}
