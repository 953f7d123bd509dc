//! Traces as other programs write them.

use std::path::{Path, PathBuf};

use tautline::trace::{TraceReader, read_traces};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/traces").join(format!("{name}.parquet"))
}

/// All points, each with the number of its trace.
fn points(name: &str) -> Vec<(u64, [f64; 2])> {
    let traces = read_traces(&file(name)).unwrap_or_else(|e| panic!("{e}"));
    traces.iter().flat_map(|t| t.points.iter().map(|p| (t.id, p.to_array()))).collect()
}

#[test]
fn columns_of_every_width_and_encoding_are_read() {
    let drag = [(0, [0.0, 0.0]), (0, [2.0, 4.0]), (0, [8.0, 0.0]), (1, [0.0, 0.0]), (1, [2.0, -4.0]), (1, [8.0, 0.0])];
    assert_eq!(points("u8"), drag);
    let five = [(0, [1.0, 0.5]), (0, [2.0, 1.0]), (0, [3.0, 2.0]), (1, [1.0, 0.5]), (1, [0.5, -1.0])];
    assert_eq!(points("pandas_cat"), five);
    assert_eq!(points("pyarrow_int16"), five);
    let four = |first: f64| [(0, [first, 0.0]), (0, [1.0, 1.0]), (1, [2.0, 2.0]), (1, [3.0, 3.0])];
    for name in ["fastparquet_cat", "pyarrow_pages_v2", "pyarrow_gzip", "pyarrow_zstd", "pyarrow_lz4"] {
        assert_eq!(points(name), four(0.1), "{name}");
    }
    // Narrow numbers are what they are, not what they were before they were narrowed.
    assert_eq!(points("pyarrow_f32"), four(f64::from(0.1f32)));
    assert_eq!(points("pyarrow_byte_stream_split"), four(f64::from(0.1f32)));
    assert_eq!(points("pyarrow_f16"), four(0.0999755859375));
}

#[test]
fn columns_that_are_not_read_are_named_as_what_they_are() {
    for (name, expected) in [
        (
            "hugeint",
            "column trace is Float64, as DuckDB writes HUGEINT; write it as a whole number of 64 bits, \
             CAST(trace AS BIGINT)",
        ),
        ("decimal", "column x is Decimal128(2, 1); write it as a number of 64 bits, CAST(x AS DOUBLE)"),
        ("duckdb_decimal_x", "column x is Decimal128(18, 3); write it as a number of 64 bits, CAST(x AS DOUBLE)"),
        (
            "polars_i128",
            "column trace is FixedSizeBinary(16), as Polars writes Int128; write it as a whole number of 64 bits, \
             cast(pl.Int64)",
        ),
        (
            "br",
            "column trace is compressed with Brotli, which is not read here; write the file with zstd or snappy \
             compression",
        ),
    ] {
        let path = file(name);
        assert_eq!(read_traces(&path).unwrap_err().to_string(), format!("{}: {expected}", path.display()));
    }
}

#[test]
fn columns_of_an_anchor_are_read_beside_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.csv");
    let rows = "0,1,2,3,4\n0,1,2,5,6\n\n4,7,8,-0,1e3\n";
    let quoted = rows.replace("0,1,2,3", "\"0\",1,2,\"3\"");
    for text in [
        format!("trace,x,y,bx,by\n{rows}"),
        format!("\u{feff}\n trace , x,y,bx,by\r\n{}", rows.replace('\n', "\r\n")),
        format!("trace,x,y,bx,by\n{quoted}"),
        format!("\"trace\",x,y,\"bx\",by\n{quoted}"),
    ] {
        std::fs::write(&path, &text).unwrap();
        let mut reader = TraceReader::open(&path).unwrap();
        assert!(reader.moves_anchor().unwrap() && reader.moves_anchor().unwrap(), "{text}");
        // Trace by trace.
        let mut read = Vec::new();
        while let Some(batch) = reader.next_ends(1, 9).unwrap() {
            assert_eq!(batch.len(), 1);
            let points = |points: &[glam::DVec2]| points.iter().map(|p| p.to_array()).collect::<Vec<_>>();
            read.extend(batch.into_iter().map(|both| (both.free.id, points(&both.free.points), points(&both.anchor))));
        }
        let first = (0, vec![[1.0, 2.0]; 2], vec![[3.0, 4.0], [5.0, 6.0]]);
        assert_eq!(read, [first, (4, vec![[7.0, 8.0]], vec![[0.0, 1e3]])], "{text}");
        assert!(read[1].2[0][0].is_sign_positive());
        // Who reads them as traces of ropes that are tied is told.
        let error = read_traces(&path).unwrap_err().to_string();
        assert!(error.contains("it has columns bx and by, so the rope's anchor moves"), "{error}");
    }
    // Without both columns there is nothing to be had, and all is as ever.
    for header in ["trace,x,y,bx,b", "trace,x,y,by,by"] {
        std::fs::write(&path, format!("{header}\n{rows}")).unwrap();
        let mut reader = TraceReader::open(&path).unwrap();
        assert!(!reader.moves_anchor().unwrap());
        assert_eq!(reader.next_ends(9, 9).unwrap(), None);
        assert_eq!(reader.next_batch(9, 9).unwrap().map(|traces| traces.len()), Some(2));
    }
}
