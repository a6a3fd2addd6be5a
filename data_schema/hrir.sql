-- HRIR-DB, schema version 2: sectors of hair and how they look (SCHEMA.md, "HRIR-DB"). BLOBs are little-endian.
-- A reader compares these statements with those of the file, so a changed character here is a new user_version.
PRAGMA page_size = 4096;              -- 65536 would hold one 34 KB row per page and double the file
PRAGMA application_id = 0x506C6765;   -- 'Plge'
PRAGMA user_version = 2;

CREATE TABLE metadata (
  id             INTEGER PRIMARY KEY CHECK (id = 1),
  settings       TEXT NOT NULL CHECK (length(settings) BETWEEN 2 AND 65536),
  revision       TEXT NOT NULL CHECK (length(revision) BETWEEN 1 AND 200),
  source         TEXT NOT NULL CHECK (source IN ('random', 'hairstyle')),
  source_name    TEXT NOT NULL CHECK (length(source_name) <= 1000),
  source_hash    TEXT NOT NULL CHECK (length(source_hash) <= 64),
  sectors        INTEGER NOT NULL CHECK (sectors BETWEEN 1 AND 1000000),
  first_row      INTEGER NOT NULL CHECK (first_row >= 0),
  end_row        INTEGER NOT NULL CHECK (end_row > first_row AND end_row <= sectors),
  feature_scales BLOB CHECK (length(feature_scales) BETWEEN 16 AND 4096),
  checksum       INTEGER NOT NULL
) STRICT;

CREATE TABLE sector (
  id        INTEGER PRIMARY KEY CHECK (id >= 0),
  features  BLOB NOT NULL CHECK (length(features) BETWEEN 4 AND 4096),
  crossings BLOB NOT NULL CHECK (length(crossings) < 1000000 AND length(crossings) % 8 = 0),
  tau       BLOB NOT NULL CHECK (length(tau) BETWEEN 1 AND 999999),
  tau_scale REAL NOT NULL CHECK (tau_scale BETWEEN 0 AND 1e6),
  re        BLOB NOT NULL CHECK (length(re) BETWEEN 1 AND 999999),
  re_scale  REAL NOT NULL CHECK (re_scale BETWEEN 0 AND 1e6),
  checksum  INTEGER NOT NULL
) STRICT;

-- For people with an SQL shell; the programs do not read it.
CREATE VIEW bake AS
  SELECT settings ->> '$.seed' AS seed, settings ->> '$.features' AS feature_set, settings ->> '$.storage' AS storage,
         settings ->> '$.views' AS views, settings ->> '$.lights' AS lights, settings ->> '$.samples' AS samples,
         sectors, source, source_name, source_hash, revision
  FROM metadata;
