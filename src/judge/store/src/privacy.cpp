// SPDX-License-Identifier: Apache-2.0
// All that is known of a person, or nothing of them any more.
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>
#include <utility>

#include "attempt_rows.h"
#include "database.h"
#include "private_file.h"
#include "sql.h"
#include "trocar/base/state_hash.h"
#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/store/courses.h"
#include "trocar/store/maintenance.h"
#include "trocar/store/names.h"
#include "trocar/store/people.h"
#include "trocar/store/spool.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using nlohmann::ordered_json;

constexpr std::int64_t kMillisecondsPerDay = 86'400'000;
constexpr std::int64_t kAttemptsAtOnce = 500;

struct RecordingFile {
  std::string path, id;
};

/// The random id in a recording's header (docs/recording.md), or empty where it is none.
std::string ReadRecordingId(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  char header[24];
  if (!file.read(header, sizeof header) || std::memcmp(header, "TROCREC\n", 8) != 0) return "";
  std::uint64_t id = 0;
  std::memcpy(&id, header + 16, sizeof id);
  return base::HashText(id);
}

/// Removes a recording and the index of states beside it. \return why not; empty where it is gone
std::string EraseRecording(const RecordingFile& recording) {
  std::error_code failure;
  if (recording.path.empty()) return "an attempt without a recording's path";
  if (!fs::exists(recording.path, failure)) return recording.path + ": not on this computer";
  // whatever else lies under that name now is not theirs
  if (ReadRecordingId(recording.path) != recording.id)
    return recording.path + ": another file has this name now";
  for (const std::string& path : {recording.path, recording.path + ".index"}) {
    if (!fs::exists(path, failure)) continue;
    if (const auto gone = EraseFile(path); !gone.ok()) return gone.error().message;
  }
  return "";
}

/// \param why_not  of EraseRecording
template <typename Report>
void NoteErasure(std::string why_not, Report& report) {
  if (why_not.empty())
    ++report.recordings;
  else
    report.left.push_back(std::move(why_not));
}

base::Result<std::vector<RecordingFile>> ListRecordings(Database& database, const std::string& where,
                                                        const Parameters& parameters) {
  const auto found = database.Run(
      "SELECT recording_path, recording_id FROM attempt WHERE " + where + " ORDER BY id", parameters);
  if (!found.ok()) return found.error();
  std::vector<RecordingFile> recordings;
  for (const Row& row : found->rows) recordings.push_back({row.Text(0), row.Text(1)});
  return recordings;
}

ordered_json TextJson(const std::string& text) {
  return EncodeText(text);
}

base::Result<ordered_json> DescribeOne(Store& store, const StoredAttempt& listed,
                                       const std::string& recording) {
  const auto found = FindAttempt(store, Viewer::Owner(), listed.id);
  if (!found.ok()) return found.error();
  const Attempt& a = found->attempt;
  ordered_json json = {{"started", TextJson(a.started)},
                       {"task", TextJson(a.task)},
                       {"level", TextJson(a.level)},
                       {"patient", TextJson(a.patient)},
                       {"seed", std::to_string(a.seed)},
                       {"seconds", a.seconds},
                       {"completed", a.is_completed},
                       {"passed", a.is_passed ? ordered_json(*a.is_passed) : ordered_json()},
                       {"score", a.score ? ordered_json(*a.score) : ordered_json()},
                       {"program", TextJson(a.program)},
                       {"recording", recording.empty() ? ordered_json() : ordered_json(recording)},
                       {"recording_id", TextJson(a.recording_id)},
                       {"verification",
                        {{"state", VerificationName(a.mark.state)},
                         {"why", WhyName(a.mark.why)},
                         {"program", TextJson(a.mark.program)},
                         {"time_ms", a.mark.time_ms ? ordered_json(*a.mark.time_ms) : ordered_json()},
                         {"claim", a.mark.claim.empty() ? ordered_json() : TextJson(a.mark.claim)}}}};
  // one that cannot be read, or is nested too deep, is theirs as well: as a text
  auto outcome = host::ParseJson<ordered_json>(a.outcome, "the outcome", host::kSmallJson);
  json["outcome"] = outcome.ok() ? std::move(*outcome) : TextJson(a.outcome);
  json["metrics"] = ordered_json::array();
  for (const training::MetricValue& m : a.metrics)
    json["metrics"].push_back({{"metric", TextJson(m.metric)},
                               {"hand", TextJson(m.hand)},
                               {"phase", TextJson(m.phase)},
                               {"tool", TextJson(m.tool)},
                               {"value", m.value}});
  const auto remarks = ListRemarks(store, Viewer::Owner(), listed.id);
  if (!remarks.ok()) return remarks.error();
  json["remarks"] = ordered_json::array();
  for (const Remark& remark : *remarks)
    json["remarks"].push_back({{"tick", remark.tick}, {"text", TextJson(remark.text)}});
  const auto ratings = ListRatings(store, Viewer::Owner(), listed.id);
  if (!ratings.ok()) return ratings.error();
  json["ratings"] = ordered_json::array();
  for (const Rating& rating : *ratings)
    json["ratings"].push_back({{"form", rating.form}, {"item", rating.item}, {"value", rating.value}});
  return json;
}

/// "a%b" as a LIKE pattern of that text anywhere.
std::string AnywherePattern(std::string_view text) {
  std::string pattern = "%";
  for (const char c : text) {
    if (c == '%' || c == '_' || c == '\\') pattern += '\\';
    pattern += c;
  }
  return pattern + "%";
}

/// Backups in the store's own folder, and what was set aside as damaged, hold everybody.
base::Status EraseCopies(const Place& place) {
  std::vector<fs::path> files;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(place.BackupFolder(), failure))
    files.push_back(entry.path());
  if (!place.IsPostgres()) {
    const fs::path store(place.url);
    const std::string aside = store.filename().string() + ".damaged-";
    for (const auto& entry : fs::directory_iterator(store.parent_path(), failure)) {
      if (entry.path().filename().string().starts_with(aside)) files.push_back(entry.path());
    }
  }
  for (const fs::path& file : files) {
    if (auto gone = EraseFile(file); !gone.ok()) return gone;
  }
  return {};
}

base::Result<std::vector<std::string>> ListForeignBackups(Database& database) {
  const auto found = database.Run("SELECT path FROM backup ORDER BY made_ms");
  if (!found.ok()) return found.error();
  std::vector<std::string> paths;
  std::error_code failure;
  for (const Row& row : found->rows) {
    // one on a drive that is not here still exists as far as anybody knows
    const fs::path path(row.Text(0));
    if (fs::exists(path, failure) || !fs::exists(path.parent_path(), failure)) paths.push_back(path.string());
  }
  return paths;
}

/// Whether a text names a pseudonym: "T-1" is not in "T-10" or "XT-1".
bool Mentions(std::string_view text, std::string_view pseudonym) {
  const auto is_letter = [&](std::size_t at) {
    return at < text.size() && std::isalnum(static_cast<unsigned char>(text[at])) != 0;
  };
  for (std::size_t at = 0; (at = text.find(pseudonym, at)) != std::string_view::npos; ++at) {
    if (!(at > 0 && is_letter(at - 1)) && !is_letter(at + pseudonym.size())) return true;
  }
  return false;
}

/// What others wrote about a person.
base::Status DeleteMentions(Database& database, const std::string& table, const std::string& pseudonym) {
  // SQLite's LIKE knows no capitals, and neither knows where a word ends
  const auto found =
      database.RunLong("SELECT id, content FROM " + table + " WHERE content LIKE $1 ESCAPE '\\'",
                       {AnywherePattern(pseudonym)});
  if (!found.ok()) return found.error();
  for (const Row& row : found->rows) {
    if (!Mentions(row.Text(1), pseudonym)) continue;
    if (auto gone = database.Run("DELETE FROM " + table + " WHERE id = $1", {row.Int(0)}); !gone.ok())
      return gone.error();
  }
  return {};
}

base::Result<std::int64_t> DeletePerson(Database& database, const Person& person) {
  return InTransaction(database, Access::kWrite, [&]() -> base::Result<std::int64_t> {
    const auto count = database.Run("SELECT COUNT(*) FROM attempt WHERE person_id = $1", {person.id});
    if (!count.ok()) return count.error();
    for (const char* table : {"remark", "certificate"}) {
      if (auto gone = DeleteMentions(database, table, person.pseudonym); !gone.ok()) return gone.error();
    }
    // everything else that is theirs goes with them (ON DELETE CASCADE)
    if (auto gone = database.RunLong("DELETE FROM person WHERE id = $1", {person.id}); !gone.ok())
      return gone.error();
    return count->rows[0].Int(0);
  });
}

}  // namespace

base::Result<int> ExportPerson(Store& store, const Viewer& viewer, std::string_view pseudonym,
                               const fs::path& folder) {
  const auto person = FindPerson(store, pseudonym);
  if (!person.ok()) return person.error();
  // their own, and an administrator's on their behalf; an instructor has no business with a copy of it all
  if (viewer.role != Role::kAdministrator && viewer.person != person->id)
    return Refused("only the person themselves and administrators may export a person's data");
  std::error_code failure;
  if (fs::exists(folder, failure) && !fs::is_empty(folder, failure))
    return base::Error{ErrorCode::kFileUnwritable,
                       folder.string() + ": there is something in it; name a new folder"};
  const auto names = ReadNames(store.GetPlace().NamesFile());
  if (!names.ok()) return names.error();
  const auto name = names->find(pseudonym);
  ordered_json json = {{"format", "trocar-person"},
                       {"version", 1},
                       {"pseudonym", TextJson(person->pseudonym)},
                       {"name", name == names->end() ? ordered_json() : TextJson(name->second)},
                       {"role", RoleName(person->role)},
                       {"groups", ordered_json::array()},
                       {"assignments", ordered_json::array()},
                       {"attempts", ordered_json::array()},
                       {"certificates", ordered_json::array()}};
  const auto groups = ListGroups(store, {person->id, Role::kTrainee});
  if (!groups.ok()) return groups.error();
  for (const Group& group : *groups) json["groups"].push_back(TextJson(group.name));
  const auto assignments = ListAssignments(store, Viewer::Owner(), pseudonym);
  if (!assignments.ok()) return assignments.error();
  for (const Assignment& assignment : *assignments)
    json["assignments"].push_back(
        {{"course", TextJson(assignment.course)},
         {"version", assignment.version},
         {"due_ms", assignment.due_ms ? ordered_json(*assignment.due_ms) : ordered_json()}});
  const auto certificates = ListCertificates(store, Viewer::Owner(), pseudonym);
  if (!certificates.ok()) return certificates.error();
  for (const Certificate& certificate : *certificates)
    json["certificates"].push_back(
        {{"key", TextJson(certificate.key)}, {"text", TextJson(certificate.text)}});
  int copied = 0;
  std::string page;
  do {
    const auto attempts = ListAttempts(store, Viewer::Owner(), {std::string(pseudonym), "", ""}, page,
                                       static_cast<int>(kAttemptsAtOnce));
    if (!attempts.ok()) return attempts.error();
    for (const StoredAttempt& stored : attempts->attempts) {
      const Attempt& a = stored.attempt;
      std::string to;
      if (!a.recording.empty() && ReadRecordingId(a.recording) == a.recording_id) {
        to = "recordings/" + a.recording_id + ".trocar";
        if (auto made = MakePrivateFolder(folder / "recordings"); !made.ok()) return made.error();
        fs::copy_file(a.recording, folder / to, fs::copy_options::skip_existing, failure);
        if (failure)
          return base::Error{IsFull(failure.value()) ? ErrorCode::kStoreFull : ErrorCode::kFileUnwritable,
                             (folder / to).string() + ": " + failure.message() + "; check the space left"};
        ++copied;
      }
      auto described = DescribeOne(store, stored, to);
      if (!described.ok()) return described.error();
      json["attempts"].push_back(std::move(*described));
    }
    page = attempts->next;
  } while (!page.empty());
  if (auto written = WritePrivateFile(folder / "person.json", host::FormatJson(json, 2) + "\n");
      !written.ok())
    return written.error();
  return copied;
}

base::Result<EraseReport> ErasePerson(Store& store, const Viewer& viewer, std::string_view pseudonym) {
  const auto person = FindPerson(store, pseudonym);
  const bool is_known = person.ok();
  if (!is_known && person.error().code != ErrorCode::kStoreUnknown) return person.error();
  // one's own, too: nobody needs another's leave for it
  if (viewer.role != Role::kAdministrator && !(is_known && viewer.person == person->id))
    return Refused("only the person themselves and administrators may erase a person");
  const Place& place = store.GetPlace();
  Database& database = store.GetDatabase();
  EraseReport report;
  if (auto gone = EraseRemnants(place); !gone.ok()) return gone.error();
  // first what waits: it must not arrive after the rows have gone
  const auto spooled = Spool(place).Erase(pseudonym);
  if (!spooled.ok()) return spooled.error();
  report.spooled = *spooled;
  const auto names = ReadNames(place.NamesFile());
  if (!names.ok()) return names.error();
  const bool has_name = names->find(pseudonym) != names->end();
  if (!is_known && !has_name && report.spooled == 0) return person.error();
  if (is_known) {
    const auto recordings = ListRecordings(database, "person_id = $1", {person->id});
    if (!recordings.ok()) return recordings.error();
    for (const RecordingFile& recording : *recordings) {
      if (recording.path.empty()) continue;  // kept without one
      NoteErasure(EraseRecording(recording), report);
    }
    const auto deleted = DeletePerson(database, *person);
    if (!deleted.ok()) return deleted.error();
    report.attempts = *deleted;
  }
  // also when an earlier run was stopped between the rows and their bytes
  if (auto purged = database.Purge(); !purged.ok()) return purged.error();
  if (has_name) {
    if (auto gone = SetName(place.NamesFile(), pseudonym, ""); !gone.ok()) return gone.error();
  }
  std::error_code failure;
  const bool had_backups =
      fs::exists(place.BackupFolder(), failure) && !fs::is_empty(place.BackupFolder(), failure);
  if (auto gone = EraseCopies(place); !gone.ok()) return gone.error();
  if (had_backups) {
    if (auto made = BackUp(store, Viewer::Owner()); !made.ok()) return made.error();
  }
  auto foreign = ListForeignBackups(database);
  if (!foreign.ok()) return foreign.error();
  report.backups = std::move(*foreign);
  return report;
}

base::Status SetRetention(Store& store, const Viewer& viewer, int days) {
  if (auto may = MayManage(viewer); !may.ok()) return may;
  if (days < 0) return Invalid("attempts are kept for a number of days, or for ever with 0");
  const auto set = store.GetDatabase().Run(
      "INSERT INTO setting (name, value) VALUES ('retention_days', $1) ON CONFLICT (name) DO UPDATE SET "
      "value = "
      "excluded.value",
      {std::to_string(days)});
  return set.ok() ? base::Status() : set.error();
}

base::Result<int> ReadRetention(Store& store) {
  const auto found = store.GetDatabase().Run("SELECT value FROM setting WHERE name = 'retention_days'");
  if (!found.ok()) return found.error();
  return found->rows.empty() ? 0 : std::atoi(found->rows[0].Text(0).c_str());
}

namespace {

/// The clock of a computer may be years off: so long after the newest thing that is known, a person is asked.
constexpr std::int64_t kLongestSilence = 180 * kMillisecondsPerDay;
constexpr std::int64_t kClockSlack = kMillisecondsPerDay;  // zones, and clocks that are set right

base::Error Unsure(const std::string& why) {
  return {ErrorCode::kUsage, why + ". Nothing was removed; if that is right, do it again with --yes"};
}

/// Why a person should look first; nothing where all is as usual.
base::Result<std::optional<base::Error>> AskFirst(Database& database, std::int64_t now_ms,
                                                  std::int64_t before_ms) {
  const auto found = database.RunLong(
      "SELECT COUNT(*), COALESCE(SUM(CASE WHEN started_ms < $1 THEN 1 ELSE 0 END), 0), "
      "COALESCE(SUM(CASE WHEN started_ms < $1 AND due_ms IS NULL THEN 1 ELSE 0 END), 0), "
      "COALESCE(MAX(started_ms), 0) FROM attempt",
      {before_ms});
  if (!found.ok()) return found.error();
  const Row& row = found->rows[0];
  const std::int64_t all = row.Int(0), old = row.Int(1), newly = row.Int(2);
  if (old == 0) return std::optional<base::Error>();
  const auto setting = database.Run("SELECT value FROM setting WHERE name = 'tidied_ms'");
  if (!setting.ok()) return setting.error();
  const std::int64_t tidied =
      setting->rows.empty() ? 0 : std::strtoll(setting->rows[0].Text(0).c_str(), nullptr, 10);
  const std::int64_t known = std::max(row.Int(3), tidied);
  if (now_ms > known + kLongestSilence)
    return std::optional(Unsure("the clock stands " + std::to_string((now_ms - known) / kMillisecondsPerDay) +
                                " days after the newest attempt and the last tidying, and by it " +
                                std::to_string(old) + " of " + std::to_string(all) +
                                " attempts are too old"));
  if (now_ms + kClockSlack < tidied)
    return std::optional(Unsure("the clock stands before the last tidying, so one of them was wrong"));
  if (2 * newly > all)
    return std::optional(Unsure(std::to_string(newly) + " of " + std::to_string(all) +
                                " attempts are older than attempts are kept: more than half"));
  return std::optional<base::Error>();
}

/// \return how many wait
base::Result<std::int64_t> MarkDue(Database& database, std::int64_t now_ms, std::int64_t before_ms) {
  return InTransaction(database, Access::kWrite, [&]() -> base::Result<std::int64_t> {
    const std::pair<std::string_view, Parameters> steps[] = {
        // they may be kept longer now, or the clock has gone back
        {"UPDATE attempt SET due_ms = NULL WHERE due_ms IS NOT NULL AND started_ms >= $1", {before_ms}},
        {"UPDATE attempt SET due_ms = $1 WHERE due_ms > $1", {now_ms}},
        {"UPDATE attempt SET due_ms = $1 WHERE due_ms IS NULL AND started_ms < $2", {now_ms, before_ms}},
        {"INSERT INTO setting (name, value) VALUES ('tidied_ms', $1) ON CONFLICT (name) DO UPDATE SET value "
         "= "
         "excluded.value",
         {std::to_string(now_ms)}}};
    for (const auto& [sql, parameters] : steps) {
      if (auto done = database.RunLong(sql, parameters); !done.ok()) return done.error();
    }
    const auto count = database.RunLong("SELECT COUNT(*) FROM attempt WHERE due_ms > $1",
                                        {now_ms - kGraceDays * kMillisecondsPerDay});
    if (!count.ok()) return count.error();
    return count->rows[0].Int(0);
  });
}

base::Status RemoveDue(Database& database, std::int64_t until_ms, TidyReport& report) {
  while (true) {
    std::int64_t count = 0;
    const auto done = InTransaction(database, Access::kWrite, [&]() -> base::Status {
      const auto old = database.Run(
          "SELECT id, recording_path, recording_id, person_id FROM attempt WHERE due_ms <= $1 ORDER BY "
          "started_ms, id LIMIT $2",
          {until_ms, kAttemptsAtOnce});
      if (!old.ok()) return old.error();
      std::set<std::int64_t> people;
      for (const Row& row : old->rows) {
        // one that was kept without a recording has none to remove
        if (!row.Text(1).empty()) NoteErasure(EraseRecording({row.Text(1), row.Text(2)}), report);
        if (const auto person = row.IntOrNull(3)) people.insert(*person);
        if (auto gone = database.Run("DELETE FROM attempt WHERE id = $1", {row.Int(0)}); !gone.ok())
          return gone.error();
      }
      for (const std::int64_t person : people) {
        if (auto counted = RecalcStandings(database, person); !counted.ok()) return counted;
      }
      count = static_cast<std::int64_t>(old->rows.size());
      return {};
    });
    if (!done.ok()) return done.error();
    report.attempts += count;
    if (count < kAttemptsAtOnce) return {};
  }
}

}  // namespace

base::Result<TidyReport> Tidy(Store& store, const Viewer& viewer, std::int64_t now_ms, bool is_sure) {
  if (auto may = MayManage(viewer); !may.ok()) return may.error();
  const auto days = ReadRetention(store);
  if (!days.ok()) return days.error();
  Database& database = store.GetDatabase();
  TidyReport report;
  // without a limit nothing is too old
  const std::int64_t before_ms =
      *days > 0 ? now_ms - *days * kMillisecondsPerDay : std::numeric_limits<std::int64_t>::min();
  if (!is_sure) {
    auto asked = AskFirst(database, now_ms, before_ms);
    if (!asked.ok()) return asked.error();
    report.unsure = std::move(*asked);
  }
  if (!report.unsure) {
    const auto due = MarkDue(database, now_ms, before_ms);
    if (!due.ok()) return due.error();
    report.due = *due;
    if (auto removed = RemoveDue(database, now_ms - kGraceDays * kMillisecondsPerDay, report); !removed.ok())
      return removed.error();
  }
  if (auto purged = database.Purge(); !purged.ok()) return purged.error();
  if (report.attempts > 0) {
    if (auto gone = EraseCopies(store.GetPlace()); !gone.ok()) return gone.error();
  }
  auto backup = BackUp(store, viewer);
  if (!backup.ok()) return backup.error();
  report.backup = std::move(*backup);
  return report;
}

base::Status UpdateStatistics(Store& store) {
  Database& database = store.GetDatabase();
  // SQLite's would keep samples of what is in the tables, and its plans need none
  if (database.GetDialect() == Dialect::kSqlite) return {};
  return database.RunScript("ANALYZE");
}

base::Result<StoreCounts> CountAll(Store& store, const Viewer& viewer) {
  if (auto may = MayManage(viewer); !may.ok()) return may.error();
  const auto found = store.GetDatabase().RunLong(
      "SELECT (SELECT COUNT(*) FROM person), (SELECT COUNT(*) FROM training_group), (SELECT COUNT(*) FROM "
      "course), "
      "(SELECT COUNT(*) FROM attempt), (SELECT COUNT(*) FROM certificate)");
  if (!found.ok()) return found.error();
  const Row& row = found->rows[0];
  return StoreCounts{row.Int(0), row.Int(1), row.Int(2), row.Int(3), row.Int(4)};
}

}  // namespace trocar::store
