//! Results as Apache Parquet: one row group, a page per column, PLAIN values, uncompressed.
//!
//! That much of the format is a page of code, where the `parquet` crate changes features of crates that
//! Zenoh is built from. Layout and numbers: <https://parquet.apache.org/docs/file-format/> and its
//! `parquet.thrift`, in Thrift's compact protocol. Tests read the files with Apache Arrow.

use super::table::{Cells, Table, finite};

const MAGIC: &[u8] = b"PAR1";

/// Physical types.
const BOOLEAN: i64 = 0;
const INT64: i64 = 2;
const DOUBLE: i64 = 5;
const BYTE_ARRAY: i64 = 6;
/// Encodings: values one after the other, and levels in runs.
const PLAIN: i64 = 0;
const RLE: i64 = 3;
/// Of a column that may have nothing in a row.
const OPTIONAL: i64 = 1;
/// Text.
const UTF8: i64 = 0;

/// Where a column's page is in the file.
struct Chunk {
    offset: i64,
    bytes: i64,
}

/// The file.
pub(super) fn bytes(table: &Table) -> Vec<u8> {
    let rows = table.count() as i64;
    let mut file = MAGIC.to_vec();
    let mut chunks = Vec::new();
    if rows > 0 {
        for (_, cells) in &table.columns {
            let offset = file.len() as i64;
            let page = page(cells);
            let size = page.len() as i64;
            let mut head = Thrift::default();
            head.whole(1, 0).whole(2, size).whole(3, size);
            head.part(5, |data| {
                data.whole(1, rows)
                    .whole(2, PLAIN)
                    .whole(3, RLE)
                    .whole(4, RLE);
            });
            file.extend(head.end());
            file.extend(page);
            let bytes = file.len() as i64 - offset;
            chunks.push(Chunk { offset, bytes });
        }
    }
    let foot = foot(table, rows, &chunks);
    file.extend(&foot);
    file.extend((foot.len() as u32).to_le_bytes());
    file.extend(MAGIC);
    file
}

fn foot(table: &Table, rows: i64, chunks: &[Chunk]) -> Vec<u8> {
    let mut foot = Thrift::default();
    foot.whole(1, 1);
    foot.list(2, table.columns.len() + 1, Thrift::STRUCT, |schema| {
        let mut root = Thrift::default();
        root.text(4, "results").whole(5, table.columns.len() as i64);
        schema.extend(root.end());
        for (name, cells) in &table.columns {
            let mut column = Thrift::default();
            column
                .whole(1, kind(cells))
                .whole(3, OPTIONAL)
                .text(4, name);
            if matches!(cells, Cells::Text(_)) {
                column.whole(6, UTF8);
                column.part(10, |logical| {
                    logical.part(1, |_| {});
                });
            }
            schema.extend(column.end());
        }
    });
    foot.long(3, rows);
    foot.list(4, usize::from(rows > 0), Thrift::STRUCT, |groups| {
        if rows == 0 {
            return;
        }
        let mut group = Thrift::default();
        group.list(1, chunks.len(), Thrift::STRUCT, |columns| {
            for ((name, cells), chunk) in table.columns.iter().zip(chunks) {
                let mut column = Thrift::default();
                column.long(2, chunk.offset);
                column.part(3, |meta| {
                    meta.whole(1, kind(cells));
                    meta.list(2, 2, Thrift::I32, |encodings| {
                        encodings.extend([PLAIN, RLE].map(|encoding| zigzag(encoding) as u8));
                    });
                    meta.list(3, 1, Thrift::BINARY, |path| put_text(path, name));
                    meta.whole(4, 0).long(5, rows).long(6, chunk.bytes);
                    meta.long(7, chunk.bytes).long(9, chunk.offset);
                });
                columns.extend(column.end());
            }
        });
        let all = chunks.iter().map(|chunk| chunk.bytes).sum();
        group.long(2, all).long(3, rows);
        groups.extend(group.end());
    });
    foot.text(6, concat!("palpate ", env!("CARGO_PKG_VERSION")));
    foot.end()
}

fn kind(cells: &Cells) -> i64 {
    match cells {
        Cells::Whole(_) => INT64,
        Cells::Number(_) => DOUBLE,
        Cells::Truth(_) => BOOLEAN,
        Cells::Text(_) => BYTE_ARRAY,
    }
}

/// Levels (which rows have a value: one run of bits, its length before it), then the values that there
/// are.
fn page(cells: &Cells) -> Vec<u8> {
    let mut values = Vec::new();
    let there: Vec<bool> = match cells {
        Cells::Whole(cells) => {
            let present = cells.iter().flatten();
            present.for_each(|value| values.extend(value.to_le_bytes()));
            cells.iter().map(Option::is_some).collect()
        }
        Cells::Number(cells) => {
            let cells: Vec<Option<f64>> = cells.iter().map(|cell| finite(*cell)).collect();
            let present = cells.iter().flatten();
            present.for_each(|value| values.extend(value.to_le_bytes()));
            cells.iter().map(Option::is_some).collect()
        }
        Cells::Truth(cells) => {
            values = bits(&cells.iter().flatten().copied().collect::<Vec<_>>());
            cells.iter().map(Option::is_some).collect()
        }
        Cells::Text(cells) => {
            for text in cells.iter().flatten() {
                values.extend((text.len() as u32).to_le_bytes());
                values.extend(text.as_bytes());
            }
            cells.iter().map(Option::is_some).collect()
        }
    };
    let packed = bits(&there);
    let mut levels = Vec::new();
    // So many groups of eight, bit-packed.
    put_varint(&mut levels, (packed.len() as u64) << 1 | 1);
    levels.extend(packed);
    let mut page = (levels.len() as u32).to_le_bytes().to_vec();
    page.extend(levels);
    page.extend(values);
    page
}

/// Eight to a byte, the first in the lowest bit.
fn bits(all: &[bool]) -> Vec<u8> {
    let byte = |eight: &[bool]| {
        let bit = |(k, set): (usize, &bool)| u8::from(*set) << k;
        eight.iter().enumerate().map(bit).sum()
    };
    all.chunks(8).map(byte).collect()
}

fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

fn put_varint(to: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        to.push(value as u8 | 0x80);
        value >>= 7;
    }
    to.push(value as u8);
}

fn put_text(to: &mut Vec<u8>, text: &str) {
    put_varint(to, text.len() as u64);
    to.extend(text.as_bytes());
}

/// A struct in Thrift's compact protocol; fields come in the order of their numbers.
#[derive(Default)]
struct Thrift {
    bytes: Vec<u8>,
    last: u8,
}

impl Thrift {
    const I32: u8 = 5;
    const I64: u8 = 6;
    const BINARY: u8 = 8;
    const LIST: u8 = 9;
    const STRUCT: u8 = 12;

    /// Numbers are below sixteen apart.
    fn field(&mut self, number: u8, kind: u8) {
        self.bytes.push((number - self.last) << 4 | kind);
        self.last = number;
    }

    fn whole(&mut self, number: u8, value: i64) -> &mut Self {
        self.field(number, Self::I32);
        put_varint(&mut self.bytes, zigzag(value));
        self
    }

    fn long(&mut self, number: u8, value: i64) -> &mut Self {
        self.field(number, Self::I64);
        put_varint(&mut self.bytes, zigzag(value));
        self
    }

    fn text(&mut self, number: u8, text: &str) -> &mut Self {
        self.field(number, Self::BINARY);
        put_text(&mut self.bytes, text);
        self
    }

    fn part(&mut self, number: u8, fill: impl FnOnce(&mut Self)) -> &mut Self {
        self.field(number, Self::STRUCT);
        let mut part = Self::default();
        fill(&mut part);
        self.bytes.extend(part.end());
        self
    }

    fn list(&mut self, number: u8, count: usize, kind: u8, fill: impl FnOnce(&mut Vec<u8>)) {
        self.field(number, Self::LIST);
        if count < 15 {
            self.bytes.push((count as u8) << 4 | kind);
        } else {
            self.bytes.push(0xf0 | kind);
            put_varint(&mut self.bytes, count as u64);
        }
        fill(&mut self.bytes);
    }

    fn end(mut self) -> Vec<u8> {
        self.bytes.push(0);
        self.bytes
    }
}
