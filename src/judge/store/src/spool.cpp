// SPDX-License-Identifier: Apache-2.0
#include "trocar/store/spool.h"

#include <sodium.h>
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "attempt_rows.h"
#include "database.h"
#include "private_file.h"
#include "sql.h"
#include "trocar/base/state_hash.h"
#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using nlohmann::ordered_json;

/// The outcome is a text of it, with escapes; that of a measured attempt has some thousand metrics.
constexpr host::JsonLimits kLimits{8u << 20, 8, 500'000, 100, 4u << 20};

std::uint32_t CalcChecksum(std::string_view text) {
  return static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size())));
}

/// A name made from the key, never from what somebody typed: neither pseudonyms nor paths are in it.
std::string FileName(const Attempt& attempt) {
  std::string key = attempt.recording_id + '\n' + attempt.started;
  unsigned char hash[16];
  [[maybe_unused]] const int started = ::sodium_init();  // again does nothing
  TROCAR_ASSERT(started >= 0);
  ::crypto_generichash(hash, sizeof hash, reinterpret_cast<const unsigned char*>(key.data()), key.size(),
                       nullptr, 0);
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string name;
  for (const unsigned char byte : hash) name += {kDigits[byte >> 4], kDigits[byte & 15]};
  return name + ".json";
}

/// The attempts of a folder, oldest first.
std::vector<fs::path> ListFiles(const fs::path& folder) {
  std::vector<std::pair<fs::file_time_type, fs::path>> found;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    if (entry.path().extension() != ".json") continue;
    const auto time = entry.last_write_time(failure);
    if (!failure) found.emplace_back(time, entry.path());
  }
  std::sort(found.begin(), found.end());
  std::vector<fs::path> files;
  for (auto& [time, path] : found) files.push_back(std::move(path));
  return files;
}

/// Whoever erased this was ended in the middle of it: EraseFile overwrites from the beginning on, with zeros.
bool IsHalfErased(std::string_view text) {
  return text.starts_with('\0');
}

/// Where another program has moved it already, that is good, too.
base::Status Move(const fs::path& from, const fs::path& folder) {
  if (auto made = MakePrivateFolder(folder); !made.ok()) return made;
  std::error_code failure;
  fs::rename(from, folder / from.filename(), failure);
  if (failure && failure != std::errc::no_such_file_or_directory)
    return base::Error{IsFull(failure.value()) ? ErrorCode::kStoreFull : ErrorCode::kFileUnwritable,
                       from.string() + ": " + failure.message() + "; check its rights"};
  return {};
}

/// 32 random bytes that only this computer's programs know. Where `makes`, they are made where there are none.
base::Result<std::string> ReadSeal(const fs::path& path, bool makes) {
  [[maybe_unused]] const int started = ::sodium_init();  // again does nothing
  TROCAR_ASSERT(started >= 0);
  auto text = host::ReadFile(path, crypto_auth_KEYBYTES + 1);
  if (text.ok() && text->size() == crypto_auth_KEYBYTES) return text;
  if (text.ok())
    return base::Error{ErrorCode::kStoreDamaged,
                       path.string() +
                           ": it is not what it was; remove it, and attempts that wait are taken as "
                           "not verified"};
  if (text.error().code != ErrorCode::kFileMissing) return text;
  if (!makes) return std::string();
  std::string secret(crypto_auth_KEYBYTES, '\0');
  ::randombytes_buf(secret.data(), secret.size());
  if (auto made = MakePrivateFileOnce(path, secret); !made.ok()) return made.error();
  return host::ReadFile(path, crypto_auth_KEYBYTES + 1);  // another program may have been first
}

std::string CalcSeal(const std::string& text, std::string_view seal) {
  unsigned char sum[crypto_auth_BYTES];
  ::crypto_auth(sum, reinterpret_cast<const unsigned char*>(text.data()), text.size(),
                reinterpret_cast<const unsigned char*>(seal.data()));
  char digits[2 * sizeof sum + 1];
  ::sodium_bin2hex(digits, sizeof digits, sum, sizeof sum);
  return digits;
}

bool HasSeal(const ordered_json& json, const std::string& text, std::string_view seal) {
  const auto found = json.find("seal");
  if (seal.size() != crypto_auth_KEYBYTES || found == json.end() || !found->is_string()) return false;
  const std::string expected = CalcSeal(text, seal), &there = found->get_ref<const std::string&>();
  return there.size() == expected.size() && ::sodium_memcmp(there.data(), expected.data(), there.size()) == 0;
}

ordered_json TextOrNull(const std::string& text) {
  return text.empty() ? ordered_json() : ordered_json(EncodeText(text));
}

}  // namespace

std::string WriteAttemptJson(const Attempt& attempt, std::string_view seal) {
  ordered_json json = {
      {"recording_id", EncodeText(attempt.recording_id)},
      {"started", EncodeText(attempt.started)},
      {"trainee", TextOrNull(attempt.trainee)},
      {"task", EncodeText(attempt.task)},
      {"level", EncodeText(attempt.level)},
      {"patient", EncodeText(attempt.patient)},
      {"seed", std::to_string(attempt.seed)},
      {"seconds", attempt.seconds},
      {"completed", attempt.is_completed},
      {"passed", attempt.is_passed ? ordered_json(*attempt.is_passed) : ordered_json()},
      {"score", attempt.score ? ordered_json(*attempt.score) : ordered_json()},
      {"outcome", EncodeText(attempt.outcome)},
      {"recording", EncodeText(attempt.recording)},
      {"program", EncodeText(attempt.program)},
      {"verification", VerificationName(attempt.mark.state)},
      {"verification_why", WhyName(attempt.mark.why)},
      {"verified_by", EncodeText(attempt.mark.program)},
      {"verified_ms", attempt.mark.time_ms ? ordered_json(*attempt.mark.time_ms) : ordered_json()},
      {"claim", EncodeText(attempt.mark.claim)},
      {"metrics", ordered_json::array()}};
  for (const training::MetricValue& m : attempt.metrics)
    json["metrics"].push_back(
        {EncodeText(m.metric), EncodeText(m.hand), EncodeText(m.phase), EncodeText(m.tool), m.value});
  const std::string text = host::FormatJson(json);
  return "{\"format\": \"trocar-attempt\", \"version\": 1, \"crc32\": " + std::to_string(CalcChecksum(text)) +
         (seal.empty() ? "" : ", \"seal\": \"" + CalcSeal(text, seal) + "\"") + ",\n\"attempt\": " + text +
         "}\n";
}

base::Result<Attempt> ReadAttemptJson(std::string_view text, const std::string& source,
                                      std::string_view seal) {
  const base::Error damaged{
      ErrorCode::kStoreDamaged,
      source + ": this waiting attempt is damaged; it is kept in the folder \"damaged\""};
  const auto parsed = host::ParseJson<ordered_json>(text, source, kLimits);
  if (!parsed.ok()) return damaged;
  const ordered_json& json = *parsed;
  for (const char* key : {"format", "version", "crc32", "attempt"}) {
    if (!json.is_object() || !json.contains(key)) return damaged;
  }
  if (json["format"] != "trocar-attempt" || !json["crc32"].is_number_unsigned() ||
      !json["attempt"].is_object())
    return damaged;
  if (json["version"] != 1)
    return base::Error{ErrorCode::kStoreSchema,
                       source + ": this attempt is of a later program; use that one"};
  if (json["crc32"].get<std::uint32_t>() != CalcChecksum(host::FormatJson(json["attempt"]))) return damaged;
  // what carries its checksum is as it was written; the fields are still checked, since anybody can write such a file
  const auto document = host::JsonDocument::Parse(host::FormatJson(json["attempt"]), source, kLimits);
  if (!document.ok()) return document.error();
  const host::JsonView view = document->Root();
  const auto text_of = [&](const char* key) { return DecodeText(view.Text(key)); };
  Attempt attempt;
  attempt.recording_id = text_of("recording_id");
  attempt.started = text_of("started");
  if (!json["attempt"].value("trainee", ordered_json()).is_null()) attempt.trainee = text_of("trainee");
  attempt.task = text_of("task");
  attempt.level = text_of("level");
  attempt.patient = text_of("patient");
  attempt.seed = std::strtoull(view.Text("seed").c_str(), nullptr, 10);
  attempt.seconds = view.Number("seconds");
  attempt.is_completed = view.BooleanOr("completed", false);
  if (!json["attempt"].value("passed", ordered_json()).is_null())
    attempt.is_passed = view.BooleanOr("passed", false);
  if (!json["attempt"].value("score", ordered_json()).is_null()) attempt.score = view.Number("score");
  attempt.outcome = text_of("outcome");
  attempt.recording = text_of("recording");
  attempt.program = text_of("program");
  attempt.mark.why = view.Has("verification") ? WhyUnverified::kImported : WhyUnverified::kEarlier;
  if (HasSeal(json, host::FormatJson(json["attempt"]), seal)) {
    const auto state = ParseVerification(view.Text("verification"));
    const auto why = ParseWhy(view.Text("verification_why"));
    if (!state || !why) view.Complain("verification or verification_why is not a word that is known");
    attempt.mark.state = state.value_or(Verification::kUnverified);
    attempt.mark.why = why.value_or(WhyUnverified::kNotYet);
    attempt.mark.program = text_of("verified_by");
    attempt.mark.claim = text_of("claim");
    if (const auto time = json["attempt"].value("verified_ms", ordered_json()); time.is_number_integer())
      attempt.mark.time_ms = time.get<std::int64_t>();
  }
  for (const host::JsonView& row : view.Array("metrics")) {
    const std::vector<host::JsonView> fields = row.Elements();
    if (fields.size() != 5) {
      row.Complain("a metric is [metric, hand, phase, tool, value]");
      continue;
    }
    attempt.metrics.push_back({DecodeText(fields[0].AsText()), DecodeText(fields[1].AsText()),
                               DecodeText(fields[2].AsText()), fields[4].AsNumber(),
                               DecodeText(fields[3].AsText())});
  }
  if (auto sound = document->Check(); !sound.ok()) return sound.error();
  return attempt;
}

base::Status Spool::Keep(const Attempt& attempt) const {
  const auto seal = ReadSeal(seal_, true);
  if (!seal.ok()) return seal.error();
  // what waits for one person is not replaced by another's
  if (const auto there = host::ReadFile(folder_ / FileName(attempt)); there.ok()) {
    const auto waiting = ReadAttemptJson(*there, "");
    if (waiting.ok() && waiting->trainee != attempt.trainee) return Conflict();
  }
  return WritePrivateFile(folder_ / FileName(attempt), WriteAttemptJson(attempt, *seal));
}

base::Status Spool::TakeBack(const Attempt& attempt) const {
  return EraseFile(folder_ / "held" / FileName(attempt));
}

namespace {

/// Whether it is the attempt that cannot be stored, and not the store that cannot take any.
bool IsOfAttempt(ErrorCode code) {
  return code == ErrorCode::kStoreDamaged || code == ErrorCode::kStoreInvalid ||
         code == ErrorCode::kJsonField || code == ErrorCode::kJsonSyntax || code == ErrorCode::kFileTooLarge;
}

struct DeliveryPlaces {
  fs::path from;
  bool stays = false;  // what the store has
  fs::path done;       // where else it goes; empty: it is removed
  fs::path held;       // of trainees that are unknown; empty: they are added
  fs::path damaged;
  fs::path seal;
};

void DeliverFolder(Store& store, const DeliveryPlaces& places, DeliveryReport& report) {
  const auto seal = ReadSeal(places.seal, false);
  if (!seal.ok()) {
    report.failure = seal.error();
    return;
  }
  for (const fs::path& file : ListFiles(places.from)) {
    const auto text = host::ReadFile(file);
    if (!text.ok()) {
      if (text.error().code == ErrorCode::kFileMissing) continue;  // another program has just delivered it
      report.failure = text.error();
      return;
    }
    if (IsHalfErased(*text)) {
      if (auto erased = EraseFile(file); !erased.ok()) {
        report.failure = erased.error();
        return;
      }
      continue;
    }
    const auto attempt = ReadAttemptJson(*text, file.filename().string(), *seal);
    base::Status moved;
    if (!attempt.ok()) {
      if (!IsOfAttempt(attempt.error().code)) {
        report.failure = attempt.error();
        return;
      }
      ++report.damaged;
      moved = Move(file, places.damaged);
    } else {
      auto added = AddAttempt(store, *attempt);
      const bool is_unknown = !added.ok() && added.error().code == ErrorCode::kStoreUnknown;
      if (is_unknown && places.held.empty()) {
        const auto person = AddPerson(store, Viewer::Owner(), Role::kTrainee, attempt->trainee);
        if (person.ok()) added = AddAttempt(store, *attempt);
      }
      const auto looked = added.ok() ? base::Result<bool>(false) : IsAnothers(store.GetDatabase(), *attempt);
      const bool is_anothers = looked.ok() && *looked;
      if (added.ok()) {
        ++(*added ? report.added : report.known);
        if (!places.stays) moved = places.done.empty() ? EraseFile(file) : Move(file, places.done);
      } else if (is_anothers && places.held.empty()) {
        ++report.known;
      } else if ((is_unknown || is_anothers) && !places.held.empty()) {
        ++report.held;
        moved = Move(file, places.held);
      } else if (added.error().code == ErrorCode::kStoreInvalid) {
        ++report.damaged;
        moved = Move(file, places.damaged);
      } else {
        report.failure = added.error();
        return;
      }
    }
    if (!moved.ok()) {
      report.failure = moved.error();
      return;
    }
  }
}

}  // namespace

DeliveryReport Spool::Deliver(Store& store) const {
  DeliveryReport report;
  DeliverFolder(store, {folder_, false, journal_, folder_ / "held", folder_ / "damaged", seal_}, report);
  return report;
}

DeliveryReport Spool::DeliverHeld(Store& store) const {
  for (const fs::path& file : ListFiles(folder_ / "held")) {
    if (auto moved = Move(file, folder_); !moved.ok()) return {0, 0, 0, 0, moved.error()};
  }
  return Deliver(store);
}

DeliveryReport Spool::DeliverJournal(Store& store) const {
  DeliveryReport report;
  DeliverFolder(store, {journal_, true, {}, {}, folder_ / "damaged", seal_}, report);
  return report;
}

std::size_t Spool::CountWaiting() const {
  return ListFiles(folder_).size();
}

std::size_t Spool::CountHeld() const {
  return ListFiles(folder_ / "held").size();
}

void Spool::ForgetJournal(std::int64_t before_ms) const {
  for (const fs::path& file : ListFiles(journal_)) {
    // moving a file into the journal changes its ctime, not its mtime
    struct stat info {};
    if (::stat(file.c_str(), &info) != 0) continue;
    const std::int64_t moved_ms =
        1000 * static_cast<std::int64_t>(info.st_ctim.tv_sec) + info.st_ctim.tv_nsec / 1000000;
    std::error_code ignored;
    if (moved_ms < before_ms) fs::remove(file, ignored);
  }
}

base::Result<int> Spool::Erase(std::string_view trainee) const {
  int erased = 0;
  std::string letters =
      host::FormatJson(ordered_json(EncodeText(trainee)));  // as it stands in a file, in quotes
  letters = letters.substr(1, letters.size() - 2);
  for (const fs::path& folder :
       {folder_, folder_ / "held", folder_ / "damaged", folder_ / "unmeasured", journal_}) {
    if (folder.empty()) continue;
    for (const fs::path& file : ListFiles(folder)) {
      const auto text = host::ReadFile(file);
      if (!text.ok()) {
        if (text.error().code == ErrorCode::kFileMissing) continue;
        return text.error();
      }
      const auto attempt = ReadAttemptJson(*text, file.filename().string());
      // in a damaged one, the letters alone tell
      const bool is_theirs =
          attempt.ok() ? attempt->trainee == trainee : text->find(letters) != std::string::npos;
      if (!is_theirs) continue;
      if (auto gone = EraseFile(file); !gone.ok()) return gone.error();
      ++erased;
    }
    std::error_code failure;
    if (fs::exists(folder, failure)) {
      if (auto synced = SyncFolder(folder); !synced.ok()) return synced.error();
    }
  }
  return erased;
}

double BackOff::Next() {
  const double most = std::min(most_, first_ * std::pow(2.0, std::min(failures_, 30)));
  ++failures_;
  // never 0: a server that is just back must not be asked in a loop
  return most * (1.0 - 0.9 * std::generate_canonical<double, 53>(random_));
}

}  // namespace trocar::store
