// Runs the statements of an SQL file on a results folder and prints the rows of the last as JSON.
// Usage: query.mjs FILE.sql RESULTS
import {readFileSync} from 'node:fs';
import {DuckDBInstance} from '@duckdb/node-api';

const [sql, results] = process.argv.slice(2);
const connection = await (await DuckDBInstance.create(':memory:')).connect();
await connection.run(`SET VARIABLE results = '${results.replaceAll("'", "''")}'`);
const reader = await connection.runAndReadAll(readFileSync(sql, 'utf8'));
process.stdout.write(JSON.stringify(reader.getRowObjectsJson()));
