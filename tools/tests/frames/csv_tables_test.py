#!/usr/bin/env python3
"""The CSV of `rubric decode` opens in pandas and DuckDB as it is: types, times, values of the JSON.

Usage: csv_tables_test.py RUBRIC [QUERY]; run in the project's folder. QUERY is the program of
tools/fleet that asks DuckDB.
"""

import io
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import pandas

import testing
from testing import FIRMWARE

QUERY = sys.argv.pop(1) if len(sys.argv) > 1 else None


def rubric(*words):
    code, out, err = testing.rubric("decode", *words)
    assert code in (0, 1), err
    return out


class Tables(unittest.TestCase):
    def test_types_and_values(self):
        for path in sorted(FIRMWARE.glob("*.pcapng")):
            with self.subTest(path.name):
                table = pandas.read_csv(io.StringIO(rubric(path, "--format", "csv")))
                frames = [json.loads(line) for line in
                          rubric(path, "--format", "jsonl").splitlines()]
                self.assertEqual(len(table), len(frames))
                for name in ("index", "offset"):
                    self.assertEqual(table[name].dtype, "int64")
                    self.assertEqual(list(table[name]), [one[name] for one in frames])
                self.assertEqual(table["time"].dtype, "float64")
                self.assertEqual(list(table["time"]), [one["time"] for one in frames])
                sources = table["am.src"].astype("Int64")
                self.assertEqual([None if pandas.isna(one) else one for one in sources],
                                 [one["am"] and one["am"]["src"] for one in frames])
                self.assertEqual(list(table["message"].fillna("")),
                                 [one["message"] or "" for one in frames])
                self.assertEqual(list(table["error.text"].fillna("")),
                                 [one["error"]["text"] if one["error"] else "" for one in frames])

    def test_dates(self):
        text = rubric(FIRMWARE / "a_join_data.pcapng", "--format", "csv", "--time", "utc")
        table = pandas.read_csv(io.StringIO(text), parse_dates=["time"])
        self.assertEqual(str(table["time"].dtype), "datetime64[ns, UTC]")
        self.assertEqual(str(table["time"][0]), "1970-01-01 00:00:00.001495+00:00")

    @unittest.skipUnless(QUERY, "no DuckDB")
    def test_duckdb(self):
        with tempfile.TemporaryDirectory() as folder:
            table, sql = pathlib.Path(folder, "a.csv"), pathlib.Path(folder, "a.sql")
            table.write_text(rubric(FIRMWARE / "h4_stale_bytes.pcapng", "--format", "csv", "--time",
                                    "utc"), encoding="utf-8")
            sql.write_text('SELECT typeof(max("time")) AS time, typeof(max("am.src")) AS src, '
                           'count(*) AS n, count("error.requirement") AS broken, '
                           "date_diff('ms', min(\"time\"), max(\"time\")) AS ms "
                           "FROM read_csv(getvariable('results'))", encoding="utf-8")
            done = subprocess.run(["node", QUERY, sql, table], capture_output=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            frames = [json.loads(line) for line in
                      rubric(FIRMWARE / "h4_stale_bytes.pcapng", "--format", "jsonl").splitlines()]
            [row] = json.loads(done.stdout)
            self.assertEqual((row["time"], row["src"]), ("TIMESTAMP WITH TIME ZONE", "BIGINT"))
            self.assertEqual((int(row["n"]), int(row["broken"])), (len(frames), 2))
            self.assertAlmostEqual(int(row["ms"]),
                                   1000 * (frames[-1]["time"] - frames[0]["time"]), delta=1)

    def test_values_of_arrays(self):
        text = rubric(FIRMWARE / "a_join_data.pcapng", "--format", "csv", "--filter",
                      "message==updates", "--fields", "src.devid,updates.value")
        table = pandas.read_csv(io.StringIO(text))
        values = table["updates.value"].str.split(expand=True).astype(int)
        self.assertEqual(list(values.iloc[0]), [302, 6402, 1202])
        self.assertEqual(set(table["src.devid"]), {2, 3, 4})


if __name__ == "__main__":
    unittest.main()
