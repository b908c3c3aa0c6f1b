//! Columns of numbers as Apache Parquet: one group of rows, plain, uncompressed.
//!
//! Source: Apache Parquet, "File Format" (`parquet.thrift`, `Encodings.md`); Apache Thrift, "Thrift Compact protocol encoding".

const MAGIC: &[u8] = b"PAR1";
/// Numbers in a page: 8 MB.
const PAGE: usize = 1 << 20;

/// Kinds of fields and members.
const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

/// The type `DOUBLE`, the encodings `PLAIN` and `RLE`.
const DOUBLE: i64 = 5;
const PLAIN: i64 = 0;
const RLE: i64 = 3;

/// A table of named columns of one length, with texts that say where it comes from.
///
/// NaN stands for what is missing. Columns longer than the shortest are cut.
#[must_use]
pub fn parquet(columns: &[(String, &[f64])], facts: &[(&str, String)]) -> Vec<u8> {
    let rows = columns.iter().map(|(_, values)| values.len()).min().unwrap_or(0);
    let mut file = MAGIC.to_vec();
    let mut chunks = Vec::new();
    for (_, values) in columns {
        let begin = file.len();
        for page in values[..rows].chunks(PAGE) {
            file.extend(page_header(page.len()));
            file.extend(page.iter().flat_map(|value| value.to_le_bytes()));
        }
        chunks.push((begin, file.len() - begin));
    }
    let footer = footer(columns, rows, &chunks, facts);
    file.extend(&footer);
    // A footer of 4 GB would be one of millions of columns.
    file.extend(u32::try_from(footer.len()).unwrap_or(u32::MAX).to_le_bytes());
    file.extend(MAGIC);
    file
}

fn page_header(numbers: usize) -> Vec<u8> {
    let bytes = 8 * numbers as i64;
    let mut out = Fields::default();
    out.int(1, I32, 0);
    out.int(2, I32, bytes);
    out.int(3, I32, bytes);
    let mut data = Fields::default();
    data.int(1, I32, numbers as i64);
    data.int(2, I32, PLAIN);
    data.int(3, I32, RLE);
    data.int(4, I32, RLE);
    out.put(5, STRUCT, &data.end());
    out.end()
}

fn footer(
    columns: &[(String, &[f64])],
    rows: usize,
    chunks: &[(usize, usize)],
    facts: &[(&str, String)],
) -> Vec<u8> {
    let mut root = Fields::default();
    root.put(4, BINARY, &text("schema"));
    root.int(5, I32, columns.len() as i64);
    let mut schema = vec![root.end()];
    let mut group = Vec::new();
    for ((name, _), (begin, bytes)) in columns.iter().zip(chunks) {
        let mut element = Fields::default();
        element.int(1, I32, DOUBLE);
        element.int(3, I32, 0);
        element.put(4, BINARY, &text(name));
        schema.push(element.end());

        let mut meta = Fields::default();
        meta.int(1, I32, DOUBLE);
        meta.put(2, LIST, &list(I32, &[zigzag(PLAIN), zigzag(RLE)]));
        meta.put(3, LIST, &list(BINARY, &[text(name)]));
        meta.int(4, I32, 0);
        meta.int(5, I64, rows as i64);
        meta.int(6, I64, *bytes as i64);
        meta.int(7, I64, *bytes as i64);
        meta.int(9, I64, *begin as i64);
        let mut chunk = Fields::default();
        chunk.int(2, I64, *begin as i64);
        chunk.put(3, STRUCT, &meta.end());
        group.push(chunk.end());
    }
    let total: usize = chunks.iter().map(|(_, bytes)| bytes).sum();
    let mut rows_of_group = Fields::default();
    rows_of_group.put(1, LIST, &list(STRUCT, &group));
    rows_of_group.int(2, I64, total as i64);
    rows_of_group.int(3, I64, rows as i64);
    let facts: Vec<Vec<u8>> = facts
        .iter()
        .map(|(key, value)| {
            let mut pair = Fields::default();
            pair.put(1, BINARY, &text(key));
            pair.put(2, BINARY, &text(value));
            pair.end()
        })
        .collect();
    let mut out = Fields::default();
    out.int(1, I32, 1);
    out.put(2, LIST, &list(STRUCT, &schema));
    out.int(3, I64, rows as i64);
    out.put(4, LIST, &list(STRUCT, &[rows_of_group.end()]));
    out.put(5, LIST, &list(STRUCT, &facts));
    out.put(6, BINARY, &text(concat!("aurt ", env!("CARGO_PKG_VERSION"))));
    out.end()
}

/// A structure in the making; its fields come in ascending order.
#[derive(Debug, Default)]
struct Fields {
    bytes: Vec<u8>,
    last: u8,
}

impl Fields {
    fn put(&mut self, id: u8, kind: u8, value: &[u8]) {
        self.bytes.push(((id - self.last) << 4) | kind);
        self.bytes.extend(value);
        self.last = id;
    }

    fn int(&mut self, id: u8, kind: u8, value: i64) {
        self.put(id, kind, &zigzag(value));
    }

    fn end(mut self) -> Vec<u8> {
        self.bytes.push(0);
        self.bytes
    }
}

fn list(kind: u8, members: &[Vec<u8>]) -> Vec<u8> {
    let mut out = match u8::try_from(members.len()) {
        Ok(count @ 0..15) => vec![(count << 4) | kind],
        _ => {
            let mut head = vec![0xf0 | kind];
            head.extend(varint(members.len() as u64));
            head
        }
    };
    out.extend(members.iter().flatten());
    out
}

fn text(text: &str) -> Vec<u8> {
    let mut out = varint(text.len() as u64);
    out.extend(text.as_bytes());
    out
}

fn zigzag(value: i64) -> Vec<u8> {
    varint(((value << 1) ^ (value >> 63)) as u64)
}

fn varint(mut value: u64) -> Vec<u8> {
    let mut out = Vec::new();
    while value > 0x7f {
        out.push((value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
    out
}
