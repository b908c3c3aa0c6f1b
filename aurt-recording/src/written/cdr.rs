//! Messages of ROS 2 in CDR, little-endian.
//!
//! Source: OMG, "DDS Interoperability Wire Protocol" 2.5, section 10.

/// A message that is being written; every value starts at a multiple of its size.
#[derive(Debug, Default)]
pub(super) struct CdrWriter {
    body: Vec<u8>,
}

impl CdrWriter {
    pub(super) fn word(&mut self, word: u32) {
        self.align(4);
        self.body.extend(word.to_le_bytes());
    }

    /// Appends seconds and nanoseconds of a time that is not negative and ends before 2038.
    pub(super) fn time(&mut self, time_ns: u64) {
        self.word((time_ns / 1_000_000_000) as u32);
        self.word((time_ns % 1_000_000_000) as u32);
    }

    /// Appends a text with the zero that ends it.
    pub(super) fn text(&mut self, text: &str) {
        self.word(text.len() as u32 + 1);
        self.body.extend(text.as_bytes());
        self.body.push(0);
    }

    pub(super) fn texts(&mut self, texts: &[String]) {
        self.word(texts.len() as u32);
        texts.iter().for_each(|text| self.text(text));
    }

    /// Appends a sequence with the value of each series at a sample; NaN where a series is shorter.
    pub(super) fn numbers(&mut self, series: &[Vec<f64>], sample: usize) {
        self.word(series.len() as u32);
        if !series.is_empty() {
            self.align(8);
        }
        for values in series {
            self.body.extend(values.get(sample).copied().unwrap_or(f64::NAN).to_le_bytes());
        }
    }

    pub(super) fn finish(self) -> Vec<u8> {
        let mut message = vec![0, 1, 0, 0];
        message.extend(self.body);
        message
    }

    fn align(&mut self, to: usize) {
        self.body.resize(self.body.len().next_multiple_of(to), 0);
    }
}
