CREATE TABLE sessions (
    started TEXT NOT NULL,   -- UTC
    evenroad TEXT NOT NULL, python TEXT NOT NULL, numpy TEXT NOT NULL, scipy TEXT NOT NULL,
    numba TEXT NOT NULL,     -- '' since nothing is compiled with it
    platform TEXT NOT NULL,
    checksum INTEGER NOT NULL   -- here and below: CRC-32 of the columns before, see checksum_of
);
CREATE TABLE names (id INTEGER PRIMARY KEY, text TEXT NOT NULL UNIQUE, checksum INTEGER NOT NULL);
-- One row a finished task. Texts are numbers of names: a million rows then load in seconds.
CREATE TABLE rows (
    key BLOB PRIMARY KEY,    -- SHA-256 of the task
    protocol INTEGER NOT NULL,
    suite INTEGER NOT NULL,
    problem INTEGER NOT NULL, instance INTEGER NOT NULL, sampler INTEGER NOT NULL, n INTEGER NOT NULL,
    rule INTEGER NOT NULL, search INTEGER NOT NULL, run INTEGER NOT NULL, seed INTEGER NOT NULL,
    status INTEGER NOT NULL, valid INTEGER NOT NULL, valid_at_solution INTEGER, edges_checked INTEGER NOT NULL,
    length REAL, seconds REAL, set_id INTEGER NOT NULL, error INTEGER NOT NULL,
    worker INTEGER NOT NULL,
    finished TEXT NOT NULL,  -- UTC
    checksum INTEGER NOT NULL   -- of the columns between `key` and `finished`
) WITHOUT ROWID;
-- For people: SELECT * FROM results.
CREATE VIEW results AS SELECT
    lower(hex(key)) AS key, protocol, of_suite.text AS suite, of_problem.text AS problem, instance,
    of_sampler.text AS sampler, n, of_rule.text AS rule, of_search.text AS search, run, seed,
    of_status.text AS status, valid, valid_at_solution, edges_checked, length, seconds,
    of_set.text AS set_id, of_error.text AS error, of_worker.text AS worker, finished
FROM rows
JOIN names of_suite ON of_suite.id = suite JOIN names of_problem ON of_problem.id = problem
JOIN names of_sampler ON of_sampler.id = sampler JOIN names of_rule ON of_rule.id = rule
JOIN names of_search ON of_search.id = search JOIN names of_status ON of_status.id = status
JOIN names of_set ON of_set.id = set_id JOIN names of_error ON of_error.id = error
JOIN names of_worker ON of_worker.id = worker;
