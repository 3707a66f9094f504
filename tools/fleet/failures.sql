-- Failures of a fleet's captures by day and rule, from the results of tools/fleet/slurm:
--   duckdb -c "SET VARIABLE results = 'RESULTS'" -f tools/fleet/failures.sql
CREATE OR REPLACE TEMP VIEW runs AS
SELECT *, make_timestamp(CAST(begin * 1000000 AS BIGINT))::DATE AS day
FROM read_json(getvariable('results') || '/shard=*/results.jsonl', hive_partitioning = true,
  columns = {file: 'VARCHAR', exit_code: 'INTEGER', verdict: 'VARCHAR', frames: 'UBIGINT',
    begin: 'DOUBLE', seconds: 'DOUBLE', error: 'VARCHAR',
    failures: 'STRUCT(requirement VARCHAR, findings UBIGINT)[]'});

SELECT day, failure.requirement AS rule, count(*) AS captures,
  CAST(sum(failure.findings) AS BIGINT) AS findings
FROM (SELECT day, unnest(failures) AS failure FROM runs)
GROUP BY ALL
ORDER BY ALL;
