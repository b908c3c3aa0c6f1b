use std::path::Path;

use crate::error::RecordingError;

/// Formats that are known but not read: their first bytes, their name, and how to get from them to one that is.
const FOREIGN: &[(&[u8], &str, &str)] = &[
    #[cfg(not(feature = "mcap"))]
    (b"\x89MCAP0", "MCAP", "build aurt-recording with its feature `mcap`"),
    #[cfg(not(feature = "mcap"))]
    (b"SQLite format 3\0", "SQLite", "build aurt-recording with its feature `mcap`, if it is a bag of ROS 2"),
    #[cfg(not(feature = "parquet"))]
    (b"PAR1", "Parquet", "build aurt-recording with its feature `parquet`"),
    #[cfg(not(feature = "numpy"))]
    (b"\x93NUMPY", "an array of NumPy", "build aurt-recording with its feature `numpy`"),
    #[cfg(not(feature = "matlab"))]
    (b"MATLAB 5.0", "a MAT-file", "build aurt-recording with its feature `matlab`"),
    (
        b"#ROSBAG V2.0",
        "a bag of ROS 1",
        "convert it to MCAP: `rosbags-convert --src FILE.bag --dst NEW --dst-storage mcap` (pip install rosbags)",
    ),
    (
        b"ARROW1\0\0",
        "an Arrow file (Feather)",
        "write it as Parquet: pandas.read_feather(\"log.arrow\").to_parquet(\"log.parquet\")",
    ),
    (
        b"\x89HDF\r\n\x1a\n",
        "an HDF5 file",
        "write its arrays to .npz: numpy.savez(\"log.npz\", time=…, q=…, current=…), or save from MATLAB with \"-v7\"",
    ),
    (b"PK\x03\x04\x14\0\x06\0", "an Excel workbook", "save it as CSV"),
    (
        b"version https://git-lfs",
        "a Git LFS pointer instead of the file",
        "fetch the file itself: `git lfs pull` in its repository",
    ),
];

/// Refuses a file that is known to be of a format that is not read.
///
/// # Errors
/// [`RecordingError::Malformed`] with the way to convert it.
pub(crate) fn refuse(path: &Path, beginning: &[u8]) -> Result<(), RecordingError> {
    match FOREIGN.iter().find(|(mark, ..)| beginning.starts_with(mark)) {
        None => Ok(()),
        Some((_, name, remedy)) => Err(RecordingError::malformed(
            path,
            "its first bytes",
            format!("it is {name}, which is not supported"),
            *remedy,
        )),
    }
}
