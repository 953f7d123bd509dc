//! Traces as other programs write them.

use std::path::{Path, PathBuf};

use tautline::trace::read_traces;

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
