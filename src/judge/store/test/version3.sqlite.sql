PRAGMA foreign_keys=OFF;
BEGIN TRANSACTION;
CREATE TABLE setting (name TEXT PRIMARY KEY, value TEXT NOT NULL);
INSERT INTO setting VALUES('schema','3');
CREATE TABLE person (
  id INTEGER PRIMARY KEY,
  pseudonym TEXT NOT NULL UNIQUE,
  role TEXT NOT NULL CHECK (role IN ('trainee', 'instructor', 'administrator')),
  added_ms BIGINT NOT NULL);
INSERT INTO person VALUES(1,'T-VERS1N','trainee',1);
INSERT INTO person VALUES(2,'T-OTHER1','trainee',2);
CREATE TABLE training_group (id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, added_ms BIGINT NOT NULL);
CREATE TABLE membership (
  group_id BIGINT NOT NULL REFERENCES training_group (id) ON DELETE CASCADE,
  person_id BIGINT NOT NULL REFERENCES person (id) ON DELETE CASCADE,
  PRIMARY KEY (group_id, person_id));
CREATE TABLE course (
  id INTEGER PRIMARY KEY,
  course_key TEXT NOT NULL,
  version BIGINT NOT NULL,
  content TEXT NOT NULL,
  UNIQUE (course_key, version));
CREATE TABLE course_step (
  course_id BIGINT NOT NULL REFERENCES course (id) ON DELETE CASCADE,
  number BIGINT NOT NULL,
  step_key TEXT NOT NULL,
  task TEXT NOT NULL,
  level TEXT NOT NULL,
  PRIMARY KEY (course_id, number),
  UNIQUE (course_id, step_key));
CREATE TABLE assignment (
  id INTEGER PRIMARY KEY,
  course_id BIGINT NOT NULL REFERENCES course (id) ON DELETE CASCADE,
  person_id BIGINT REFERENCES person (id) ON DELETE CASCADE,
  group_id BIGINT REFERENCES training_group (id) ON DELETE CASCADE,
  assigned_ms BIGINT NOT NULL,
  due_ms BIGINT,
  CHECK ((person_id IS NULL) <> (group_id IS NULL)));
CREATE TABLE assignment_due (
  assignment_id BIGINT NOT NULL REFERENCES assignment (id) ON DELETE CASCADE,
  step_key TEXT NOT NULL,
  due_ms BIGINT NOT NULL,
  PRIMARY KEY (assignment_id, step_key));
CREATE TABLE threshold (
  task TEXT NOT NULL,
  level TEXT NOT NULL,
  metric TEXT NOT NULL,
  hand TEXT NOT NULL,
  phase TEXT NOT NULL,
  tool TEXT NOT NULL,
  value REAL NOT NULL,
  more_is_better BIGINT NOT NULL,
  source TEXT NOT NULL,
  PRIMARY KEY (task, level, metric, hand, phase, tool));
CREATE TABLE attempt (
  id INTEGER PRIMARY KEY,
  recording_id TEXT NOT NULL,
  started TEXT NOT NULL,
  started_ms BIGINT NOT NULL,
  person_id BIGINT REFERENCES person (id) ON DELETE CASCADE,
  task TEXT NOT NULL,
  level TEXT NOT NULL,
  patient TEXT NOT NULL,
  seed TEXT NOT NULL,
  seconds REAL NOT NULL,
  completed BIGINT NOT NULL,
  passed BIGINT,
  score REAL,
  outcome TEXT NOT NULL,
  recording_path TEXT NOT NULL,
  program TEXT NOT NULL, verification TEXT NOT NULL DEFAULT 'unverified'
  CHECK (verification IN ('unverified', 'verified', 'recorded_here', 'accepted', 'refused')), verification_why TEXT NOT NULL DEFAULT 'not_yet', verified_by TEXT NOT NULL DEFAULT '', verified_ms BIGINT, claim TEXT NOT NULL DEFAULT '', due_ms BIGINT,
  UNIQUE (recording_id, started));
INSERT INTO attempt VALUES(1,'0000000000000001','2026-11-24T22:50:20+01:00',1795557020000,1,'peg_transfer','','','0',60.0,1,NULL,1.0,'{}','','','accepted','earlier','',NULL,'',NULL);
INSERT INTO attempt VALUES(2,'0000000000000002','2026-11-24T22:50:20+01:00',1795557020000,1,'peg_transfer','','','0',60.0,1,NULL,2.0,'{}','','','accepted','earlier','',NULL,'',NULL);
INSERT INTO attempt VALUES(3,'000000000000000a','2026-11-24T22:50:20+01:00',1795557020000,2,'peg_transfer','','','0',60.0,1,NULL,10.0,'{}','','','accepted','earlier','',NULL,'',NULL);
CREATE TABLE metric (
  attempt_id BIGINT NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  metric TEXT NOT NULL,
  hand TEXT NOT NULL,
  phase TEXT NOT NULL,
  tool TEXT NOT NULL,
  value REAL NOT NULL,
  PRIMARY KEY (attempt_id, metric, hand, phase, tool)) WITHOUT ROWID;
INSERT INTO metric VALUES(1,'path_length','left','','',1.0);
INSERT INTO metric VALUES(1,'path_length','right','','',2.0);
INSERT INTO metric VALUES(1,'score','','','',1.0);
INSERT INTO metric VALUES(1,'seconds','','','',60.0);
INSERT INTO metric VALUES(2,'path_length','left','','',2.0);
INSERT INTO metric VALUES(2,'path_length','right','','',2.0);
INSERT INTO metric VALUES(2,'score','','','',2.0);
INSERT INTO metric VALUES(2,'seconds','','','',60.0);
INSERT INTO metric VALUES(3,'path_length','left','','',10.0);
INSERT INTO metric VALUES(3,'path_length','right','','',2.0);
INSERT INTO metric VALUES(3,'score','','','',10.0);
INSERT INTO metric VALUES(3,'seconds','','','',60.0);
CREATE TABLE standing (
  task TEXT NOT NULL,
  level TEXT NOT NULL,
  metric TEXT NOT NULL,
  hand TEXT NOT NULL,
  person_id BIGINT NOT NULL REFERENCES person (id) ON DELETE CASCADE,
  attempts BIGINT NOT NULL,
  latest REAL NOT NULL,
  latest_ms BIGINT NOT NULL,
  lowest REAL NOT NULL,
  highest REAL NOT NULL,
  PRIMARY KEY (task, level, metric, hand, person_id)) WITHOUT ROWID;
INSERT INTO standing VALUES('peg_transfer','','path_length','left',1,2,2.0,1795557020000,1.0,2.0);
INSERT INTO standing VALUES('peg_transfer','','path_length','left',2,1,10.0,1795557020000,10.0,10.0);
INSERT INTO standing VALUES('peg_transfer','','path_length','right',1,2,2.0,1795557020000,2.0,2.0);
INSERT INTO standing VALUES('peg_transfer','','path_length','right',2,1,2.0,1795557020000,2.0,2.0);
INSERT INTO standing VALUES('peg_transfer','','score','',1,2,2.0,1795557020000,1.0,2.0);
INSERT INTO standing VALUES('peg_transfer','','score','',2,1,10.0,1795557020000,10.0,10.0);
INSERT INTO standing VALUES('peg_transfer','','seconds','',1,2,60.0,1795557020000,60.0,60.0);
INSERT INTO standing VALUES('peg_transfer','','seconds','',2,1,60.0,1795557020000,60.0,60.0);
CREATE TABLE rating (
  attempt_id BIGINT NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  rater_id BIGINT NOT NULL REFERENCES person (id) ON DELETE CASCADE,
  form TEXT NOT NULL,
  item TEXT NOT NULL,
  value BIGINT NOT NULL,
  rated_ms BIGINT NOT NULL,
  PRIMARY KEY (attempt_id, rater_id, form, item));
CREATE TABLE remark (
  id INTEGER PRIMARY KEY,
  attempt_id BIGINT NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  author_id BIGINT REFERENCES person (id) ON DELETE CASCADE,
  tick BIGINT NOT NULL,
  content TEXT NOT NULL,
  written_ms BIGINT NOT NULL);
CREATE TABLE certificate (
  id INTEGER PRIMARY KEY,
  certificate_key TEXT NOT NULL UNIQUE,
  person_id BIGINT REFERENCES person (id) ON DELETE CASCADE,
  content TEXT NOT NULL,
  issued_ms BIGINT NOT NULL);
CREATE TABLE backup (path TEXT PRIMARY KEY, made_ms BIGINT NOT NULL);
CREATE INDEX membership_by_person ON membership (person_id, group_id);
CREATE UNIQUE INDEX assignment_of_person ON assignment (person_id, course_id);
CREATE UNIQUE INDEX assignment_of_group ON assignment (group_id, course_id);
CREATE INDEX attempt_by_person ON attempt (person_id, started_ms, id);
CREATE INDEX attempt_by_person_task ON attempt (person_id, task, started_ms, id);
CREATE INDEX attempt_by_task ON attempt (task, started_ms, id);
CREATE INDEX attempt_by_time ON attempt (started_ms, id);
CREATE INDEX standing_by_person ON standing (person_id);
CREATE INDEX rating_by_rater ON rating (rater_id);
CREATE INDEX remark_by_attempt ON remark (attempt_id, tick);
CREATE INDEX remark_by_author ON remark (author_id);
CREATE INDEX certificate_by_person ON certificate (person_id);
COMMIT;
