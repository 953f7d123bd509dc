"""What tables of other libraries really send, and what they take back."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tautrope import InputError, Ropes, Scene

duckdb = pytest.importorskip("duckdb")
pa = pytest.importorskip("pyarrow")
pandas = pytest.importorskip("pandas")
polars = pytest.importorskip("polars")


@pytest.fixture(scope="module")
def expected(rooms: Scene, walks: np.ndarray) -> Any:
    return rooms.evaluate(walks, engine="cpu").to_arrow()


@pytest.fixture
def table(columns: dict[str, np.ndarray]) -> Any:
    return pa.table(columns)


def ropes_of(scene: Scene, given: Any) -> Any:
    return scene.evaluate(given, engine="cpu").to_arrow()


def test_every_library_hands_over(rooms: Scene, columns: dict[str, Any], table: Any, expected: Any) -> None:
    import arro3.core
    import nanoarrow

    frame = pandas.DataFrame(columns)
    forms = [frame, polars.DataFrame(columns), table, duckdb.sql("SELECT * FROM frame")]
    forms += [arro3.core.Table.from_arrow(table)]
    forms += [nanoarrow.ArrayStream(table), table.to_reader(max_chunksize=999), pa.RecordBatchReader.from_stream(table)]
    for given in forms:
        assert ropes_of(rooms, given).equals(expected), type(given)


@pytest.mark.parametrize("kind", ["int64", "int32", "uint32", "int16", "uint16", "uint64"])
def test_numbers_of_traces_of_any_width(rooms: Scene, table: Any, expected: Any, kind: str) -> None:
    assert ropes_of(rooms, table.set_column(0, "trace", table["trace"].cast(kind))).equals(expected)


def test_numbers_of_traces_in_other_forms(rooms: Scene, columns: dict[str, Any], table: Any, expected: Any) -> None:
    frame = pandas.DataFrame(columns)
    few = {name: column[columns["trace"] < 100] for name, column in columns.items()}
    for kind in ("int8", "uint8"):
        narrow = pa.table(few).set_column(0, "trace", pa.array(few["trace"]).cast(kind))
        assert ropes_of(rooms, narrow).equals(expected.slice(0, 100))
    assert ropes_of(rooms, frame.astype({"trace": "category"})).equals(expected)
    assert ropes_of(rooms, table.set_column(0, "trace", table["trace"].dictionary_encode())).equals(expected)
    # DuckDB's sum of whole numbers.
    wide = duckdb.sql("SELECT CAST(trace AS DECIMAL(38, 0)) AS trace, x, y FROM frame")
    assert pa.types.is_decimal(wide.to_arrow_table().schema.field("trace").type)
    assert ropes_of(rooms, wide).equals(expected)
    assert ropes_of(rooms, frame.convert_dtypes(dtype_backend="pyarrow")).equals(expected)


def test_points_in_narrow_numbers(rooms: Scene, columns: dict[str, Any]) -> None:
    near = {name: column[:5] for name, column in columns.items()}
    for kind in ("float32", "float16"):
        narrow = {**near, "x": near["x"].astype(kind), "y": near["y"].astype(kind)}
        widened = {name: column.astype(np.float64) if name != "trace" else column for name, column in narrow.items()}
        assert ropes_of(rooms, pa.table(narrow)).equals(ropes_of(rooms, widened))
    whole = pa.table({"trace": [0, 0], "x": pa.array([24, 24], "int8"), "y": pa.array([9, 9], "uint64")})
    floats = {"trace": [0, 0], "x": [24.0, 24.0], "y": [9.0, 9.0]}
    assert ropes_of(rooms, whole).equals(ropes_of(rooms, floats))
    large = pa.table({"trace": [0], "x": pa.array([2**53 + 1], "int64"), "y": [9.0]})
    with pytest.raises(InputError, match="row 0: column x: 9007199254740993 has more digits"):
        rooms.evaluate(large)


def test_columns_in_any_order_among_others(rooms: Scene, table: Any, expected: Any) -> None:
    texts = [pa.array(["a"] * len(table), kind) for kind in (pa.string(), pa.large_string(), pa.string_view())]
    lists = [pa.array([[1]] * len(table), kind) for kind in (pa.list_(pa.float64()), pa.large_list(pa.int8()))]
    more = {f"more{i}": column for i, column in enumerate([*texts, *lists])}
    other = pa.table({"y": table["y"], **more, "trace": table["trace"], "x": table["x"]})
    assert ropes_of(rooms, other).equals(expected)


@pytest.mark.parametrize("column", ["trace", "x", "y"])
def test_missing_numbers_are_refused_with_their_row(rooms: Scene, columns: dict[str, Any], column: str) -> None:
    frame = pandas.DataFrame(columns).astype({"trace": "Int64", "x": "Float64", "y": "Float64"})
    frame.loc[200, column] = pandas.NA
    for given in (frame, polars.from_pandas(frame), pa.Table.from_pandas(frame)):
        with pytest.raises(InputError, match=f"row 200: column {column} is null") as caught:
            rooms.evaluate(given)
        assert caught.value.row == 200
    if column != "trace":
        numpy = pandas.DataFrame(columns)
        numpy.loc[200, column] = np.nan
        # pandas sends NaN of numpy as null, polars as NaN.
        for given in (numpy, polars.DataFrame({**columns, column: numpy[column].to_numpy()}), numpy.to_dict("list")):
            with pytest.raises(InputError, match=f"row 200: column {column}"):
                rooms.evaluate(given)


def test_a_null_row_is_no_trace_at_the_origin(rooms: Scene, columns: dict[str, Any]) -> None:
    few = {name: pa.array(column[:4]) for name, column in columns.items()}
    rows = pa.StructArray.from_arrays(list(few.values()), list(few), mask=pa.array([False, False, True, False]))

    class Stream:
        def __arrow_c_stream__(self, requested_schema: object = None) -> Any:
            return pa.chunked_array([rows]).__arrow_c_stream__(requested_schema)

    with pytest.raises(InputError, match="row 2: the row is null"):
        rooms.evaluate(Stream())
    categories = pa.DictionaryArray.from_arrays(pa.array([0, 1, 1], "int8"), pa.array([0, None], "int64"))
    with pytest.raises(InputError, match="row 1: column trace is null"):
        rooms.evaluate(pa.table({"trace": categories, "x": [24.3] * 3, "y": [9.2] * 3}))


def test_empty_tables(rooms: Scene, columns: dict[str, Any], table: Any) -> None:
    empty = pandas.DataFrame(columns)[:0]
    forms = [empty, polars.from_pandas(empty), table.slice(0, 0), duckdb.sql("SELECT * FROM empty")]
    forms += [pa.RecordBatchReader.from_batches(table.schema, [])]
    for given in forms:
        ropes = rooms.evaluate(given)
        assert len(ropes) == 0 and ropes.to_arrow().num_rows == 0
        assert ropes.to_polars().shape == (0, 11) and ropes.to_pandas().shape == (0, 12)


def test_a_stream_serves_once(rooms: Scene, table: Any) -> None:
    class Once:
        def __init__(self) -> None:
            self.capsule = table.__arrow_c_stream__()

        def __arrow_c_stream__(self, requested_schema: object = None) -> Any:
            return self.capsule

    once = Once()
    assert len(rooms.evaluate(once)) == 300
    with pytest.raises(InputError, match="read once"):
        rooms.evaluate(once)


def test_duckdb_goes_on_after_its_stream_was_read(rooms: Scene, columns: dict[str, Any], expected: Any) -> None:
    frame = pandas.DataFrame(columns)
    with duckdb.connect() as connection:
        connection.execute("CREATE TABLE walks AS SELECT * FROM frame")
        ropes = rooms.evaluate(connection.sql("SELECT * FROM walks ORDER BY trace, rowid"), engine="cpu")
        assert ropes.to_arrow().equals(expected)
        assert connection.sql("SELECT count(*) FROM walks").fetchall() == [(len(frame),)]
        found = connection.sql("SELECT max(max_length), count(*) FROM ropes").fetchall()
        assert found == [(ropes["max_length"].max(), 300)]


def test_rows_out_of_order_are_seen_by_their_steps(rooms: Scene, columns: dict[str, Any]) -> None:
    frame = pandas.DataFrame({**columns, "step": np.tile(np.arange(121), 300)})
    shuffled = pandas.concat([frame[:5], frame[6:7], frame[5:6], frame[7:]])
    for given in (shuffled, polars.from_pandas(shuffled), shuffled.to_dict("list")):
        with pytest.raises(InputError, match="row 6: trace 0: step 5 after step 6"):
            rooms.evaluate(given)
    assert len(rooms.evaluate(shuffled.sort_values(["trace", "step"]))) == 300
    with pytest.raises(InputError, match="row 121: trace 298 after trace 299"):
        rooms.evaluate(frame.iloc[::-1].drop(columns="step"))


@pytest.mark.parametrize(
    ("columns_", "message"),
    [
        ({"trace": [0], "x": [1.0]}, "no column y among trace, x"),
        ({"trace": [0.5], "x": [1.0], "y": [1.0]}, "column trace is Float64"),
        ({"trace": ["0"], "x": [1.0], "y": [1.0]}, "column trace is"),
        ({"trace": [-1], "x": [1.0], "y": [1.0]}, "row 0: column trace: -1 is not a whole number"),
        ({"trace": [0], "x": ["1"], "y": [1.0]}, "column x is .*; cast it to Float64"),
    ],
)
def test_other_columns_are_refused(rooms: Scene, columns_: dict[str, Any], message: str) -> None:
    for given in (pa.table(columns_), polars.DataFrame(columns_)):
        with pytest.raises(InputError, match=message):
            rooms.evaluate(given)


def test_two_columns_of_one_name(rooms: Scene) -> None:
    with pytest.raises(InputError, match="two columns x"):
        rooms.evaluate(pa.Table.from_arrays([[0], [1.0], [1.0], [1.0]], ["trace", "x", "x", "y"]))


def test_results_go_to_every_library(rooms: Scene, walks: np.ndarray) -> None:
    """And cut ones stay as they are: the types handed back are those that all readers slice soundly."""
    import arro3.core
    import nanoarrow

    ropes: Ropes = rooms.evaluate(walks, engine="cpu")
    rows = ropes.to_arrow().to_pylist()
    assert [pa.types.is_list(ropes.to_arrow().schema.field(name).type) for name in ("wraps", "sides")] == [True, True]
    assert polars.DataFrame(ropes).slice(10, 5).to_dicts() == rows[10:15]
    assert duckdb.sql("SELECT * FROM ropes LIMIT 5 OFFSET 10").to_arrow_table().to_pylist() == rows[10:15]
    assert pa.table(arro3.core.Table.from_arrow(ropes)).to_pylist() == rows
    assert nanoarrow.ArrayStream(ropes).read_all().to_pylist()[10]["max_length"] == rows[10]["max_length"]
    frame = ropes.to_arrow().to_pandas()
    assert frame[10:15]["max_length"].tolist() == [row["max_length"] for row in rows[10:15]]
    assert [len(w) for w in frame["wraps"][10:15]] == [len(row["wraps"]) for row in rows[10:15]]


def test_pandas_does_without_pyarrow(rooms: Scene, columns: dict[str, Any], expected: Any) -> None:
    class Frame(pandas.DataFrame):  # type: ignore[misc]
        def __arrow_c_stream__(self, requested_schema: object = None) -> Any:
            raise ImportError("pyarrow is not here")

    assert ropes_of(rooms, Frame(columns)).equals(expected)
