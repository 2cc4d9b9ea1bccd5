// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/xapi.h"

#include <fcntl.h>
#include <sodium.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"
#include "trocar/host/user_folder.h"

namespace trocar::report {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kVerbs = "http://adlnet.gov/expapi/verbs/";
constexpr const char* kActivityType = "http://adlnet.gov/expapi/activities/simulation";
constexpr double kFullScore = 100;            // an able surgeon's [%]
constexpr std::size_t kMostBytes = 1u << 20;  // of a statement's file

/// A UUID that looks like a random one (version 4) and is the same for the same text.
std::string MakeUuid(const std::string& text) {
  std::array<unsigned char, 16> bytes;
  crypto_generichash(bytes.data(), bytes.size(), reinterpret_cast<const unsigned char*>(text.data()),
                     text.size(), nullptr, 0);
  bytes[6] = static_cast<unsigned char>((bytes[6] & 0x0f) | 0x40);
  bytes[8] = static_cast<unsigned char>((bytes[8] & 0x3f) | 0x80);
  char uuid[40];
  char* out = uuid;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) *out++ = '-';
    out += std::snprintf(out, 3, "%02x", bytes[i]);
  }
  return uuid;
}

/// Of an IRI's part: letters, digits and few signs stay, all else is written as %NN (RFC 3986).
std::string EncodePart(std::string_view text) {
  std::string encoded;
  for (const char c : text) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          c == '-' || c == '_' || c == '.';
    char hex[4];
    std::snprintf(hex, sizeof hex, "%%%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
    encoded += is_plain ? std::string(1, c) : hex;
  }
  return encoded;
}

/// "2026-11-24T21:50:20Z", so many seconds after an RFC 3339 time; empty where it is none.
std::string AddSeconds(const std::string& time, double seconds) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0, read = 0;
  if (std::sscanf(time.c_str(), "%4d-%2d-%2dT%2d:%2d:%2d%n", &year, &month, &day, &hour, &minute, &second,
                  &read) != 6)
    return "";
  int offset_hour = 0, offset_minute = 0;
  const std::size_t sign = time.find_first_of("+-", static_cast<std::size_t>(read));
  if (sign != std::string::npos &&
      std::sscanf(time.c_str() + sign + 1, "%2d:%2d", &offset_hour, &offset_minute) != 2)
    return "";
  const int offset =
      (sign != std::string::npos && time[sign] == '-' ? -60 : 60) * (60 * offset_hour + offset_minute);
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return "";
  const std::int64_t clock = 3600LL * hour + 60 * minute + second - offset + std::llround(seconds);
  const auto moment = std::chrono::sys_days(date) + std::chrono::seconds(clock);
  const auto midnight = std::chrono::floor<std::chrono::days>(moment);
  const std::chrono::year_month_day of_day(midnight);
  const auto left = (moment - midnight).count();
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d:%02d:%02dZ", static_cast<int>(of_day.year()),
                static_cast<unsigned>(of_day.month()), static_cast<unsigned>(of_day.day()),
                static_cast<int>(left / 3600), static_cast<int>(left / 60 % 60), static_cast<int>(left % 60));
  return text;
}

ordered_json Word(const char* word) {
  return {{"en", word}};
}

ordered_json MakeActivity(const AttemptFacts& facts) {
  std::string id = "urn:trocar:task:" + EncodePart(facts.task_key);
  if (!facts.level.empty()) id += ":level:" + EncodePart(facts.level);
  return {{"objectType", "Activity"},
          {"id", id},
          {"definition",
           {{"type", kActivityType},
            {"name", {{"en", facts.task + (facts.level.empty() ? "" : ", " + facts.level)}}}}}};
}

ordered_json MakeScore(const AttemptReport& report) {
  ordered_json score = {{"raw", *report.score}};
  if (report.facts.best_score) {
    // better than the reference is the best that a scaled score can say
    score["scaled"] = std::clamp(*report.score / kFullScore, 0.0, 1.0);
  }
  return score;
}

ordered_json MakeExtensions(const AttemptReport& report) {
  std::array<int, 3> errors{};
  for (const ErrorRow& error : report.errors) ++errors[static_cast<std::size_t>(error.severity)];
  ordered_json extensions = {{"urn:trocar:seed", report.facts.seed},
                             {"urn:trocar:errors:minor", errors[0]},
                             {"urn:trocar:errors:major", errors[1]},
                             {"urn:trocar:errors:critical", errors[2]}};
  if (report.is_operation)
    extensions["urn:trocar:critical-view-achieved"] = report.critical_view_time.has_value();
  for (const MetricRow& row : report.metrics) {
    if (!row.phase.empty() || !row.tool.empty()) continue;
    std::string key = "urn:trocar:metric:" + EncodePart(row.id);
    if (!row.hand.empty()) key += ":" + EncodePart(row.hand);
    extensions[key] = row.scale != 0 ? row.value / row.scale : row.value;
  }
  return extensions;
}

std::string FormatPeriod(double seconds) {
  char text[40];
  std::snprintf(text, sizeof text, "PT%.2fS", std::fmax(seconds, 0));
  return text;
}

base::Error Unwritable(const fs::path& path) {
  return {base::ErrorCode::kFileUnwritable,
          path.string() + ": " + std::strerror(errno) + "; check the folder, its rights and the space left"};
}

base::Status SyncPath(const fs::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) return Unwritable(path);
  const bool is_synced = ::fsync(descriptor) == 0;
  const int why = errno;
  ::close(descriptor);
  errno = why;
  return is_synced ? base::Status() : Unwritable(path);
}

/// Survives a power cut once it has returned.
base::Status WriteSynced(const fs::path& path, const std::string& content) {
  std::error_code failure;
  const fs::path folder = path.parent_path();
  // a new folder's own entry lies in its parent
  const bool is_new = !fs::exists(folder, failure);
  failure = host::MakeFolders(folder);
  if (is_new && folder.has_parent_path()) {
    if (auto status = SyncPath(folder.parent_path(), O_RDONLY | O_DIRECTORY); !status.ok()) return status;
  }
  const fs::path part = path.string() + ".part";
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (descriptor < 0) return Unwritable(part);
  std::size_t written = 0;
  bool is_good = true;
  while (is_good && written < content.size()) {
    const ssize_t count = ::write(descriptor, content.data() + written, content.size() - written);
    if (count < 0 && errno == EINTR) continue;
    is_good = count > 0;
    if (is_good) written += static_cast<std::size_t>(count);
  }
  is_good = is_good && ::fsync(descriptor) == 0;
  const int why = errno;
  is_good = ::close(descriptor) == 0 && is_good;
  if (!is_good) {
    errno = why;
    const base::Error error = Unwritable(part);
    fs::remove(part, failure);
    return error;
  }
  if (std::rename(part.c_str(), path.c_str()) != 0) return Unwritable(path);
  return SyncPath(folder, O_RDONLY | O_DIRECTORY);
}

std::vector<fs::path> ListFiles(const fs::path& folder) {
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    if (entry.path().extension() == ".json" && entry.is_regular_file(failure))
      files.emplace_back(entry.last_write_time(failure), entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<fs::path> paths;
  for (auto& [time, path] : files) paths.push_back(std::move(path));
  return paths;
}

std::optional<XapiStatement> ReadStatement(const fs::path& path) {
  auto text = host::ReadFile(path, kMostBytes);
  if (!text.ok()) return std::nullopt;
  const auto json = host::ParseJson<nlohmann::json>(*text, path.string(), host::kSmallJson);
  if (!json.ok() || !json->is_object() || !json->contains("id") || (*json)["id"] != path.stem().string())
    return std::nullopt;
  return XapiStatement{path.stem().string(), std::move(*text)};
}

/// The pseudonym that a statement is about; empty where it names none.
std::string FindAccountName(std::string_view statement) {
  const auto json = host::ParseJson<nlohmann::json>(statement, "", host::kSmallJson);
  const nlohmann::json* at = json.ok() ? &*json : nullptr;
  for (const char* key : {"actor", "account", "name"}) {
    if (at == nullptr || !at->is_object() || !at->contains(key)) return {};
    at = &at->at(key);
  }
  return at->is_string() ? at->get<std::string>() : std::string();
}

void EraseFile(const fs::path& path, const std::string& pseudonym, XapiErasure& erasure) {
  std::error_code failure;
  const std::string ending = path.extension().string();
  const bool is_statement = ending == ".json",
             is_half = ending == ".part";  // of a program that was killed
  const bool is_reason = ending == ".txt";
  if ((!is_statement && !is_half && !is_reason) || !fs::is_regular_file(path, failure)) return;
  const auto text = host::ReadFile(path, kMostBytes);
  if (!text.ok() && !is_half) {
    if (fs::exists(path, failure)) erasure.left.push_back(host::ShownText(text.error()));
    return;
  }
  const std::string name = text.ok() ? FindAccountName(*text) : std::string();
  const bool is_named = !text.ok() || text->find(pseudonym) != std::string::npos;
  if (name != pseudonym && !(is_named && !is_statement)) {
    if (name.empty() && is_named)
      erasure.left.push_back(host::TranslateWith(
          "{1}: it is no whole statement, and names this person; look at it, and delete it",
          {path.string()}));
    return;
  }
  if (!fs::remove(path, failure) && failure) {
    erasure.left.push_back(path.string() + ": " + failure.message());
    return;
  }
  if (is_statement) fs::remove(fs::path(path).replace_extension(".txt"), failure);
  if (!is_reason) ++erasure.statements;
}

}  // namespace

base::Result<std::vector<XapiStatement>> MakeStatements(const AttemptReport& report,
                                                        const XapiSettings& settings) {
  const AttemptFacts& facts = report.facts;
  if (facts.person.empty())
    return base::Error{base::ErrorCode::kUsage, "whose attempt it is must be said: --person PSEUDONYM"};
  if (settings.home_page.rfind("http://", 0) != 0 && settings.home_page.rfind("https://", 0) != 0)
    return base::Error{
        base::ErrorCode::kUsage,
        "the accounts' home page must be an address such as https://training.hospital.example"};
  if (facts.is_as_recorded == false)
    return base::Error{
        base::ErrorCode::kRecordingInvalid,
        "the recording's file claims another outcome than its replay comes to, and no statement "
        "is made of it; trocar replay --verify shows both"};
  const std::string attempt = settings.home_page + '\n' + facts.person + '\n' + facts.task_key + '\n' +
                              facts.level + '\n' + std::to_string(facts.seed) + '\n' + facts.started + '\n' +
                              facts.recording;
  const ordered_json actor = {{"objectType", "Agent"},
                              {"account", {{"homePage", settings.home_page}, {"name", facts.person}}}};
  std::vector<XapiStatement> statements;
  const auto add = [&](const char* verb, double after, ordered_json result) {
    const std::string id = MakeUuid(attempt + '\n' + verb);
    ordered_json json = {{"id", id},
                         {"actor", actor},
                         {"verb", {{"id", kVerbs + std::string(verb)}, {"display", Word(verb)}}},
                         {"object", MakeActivity(facts)}};
    if (!result.empty()) json["result"] = std::move(result);
    json["context"] = {{"registration", MakeUuid(attempt)},
                       {"platform", "Trocar" + (facts.program.empty() ? "" : " " + facts.program)},
                       {"language", "en"}};
    if (const std::string time = AddSeconds(facts.started, after); !time.empty()) json["timestamp"] = time;
    statements.push_back({id, host::FormatJson(json)});
  };
  add("attempted", 0, {});
  ordered_json result = {{"completion", report.is_completed}, {"duration", FormatPeriod(report.seconds)}};
  if (report.score && report.is_completed) result["score"] = MakeScore(report);
  if (settings.is_passed) result["success"] = *settings.is_passed;
  const ordered_json short_result = result;
  result["extensions"] = MakeExtensions(report);
  add(report.is_completed ? "completed" : "terminated", report.seconds, result);
  if (report.score && report.is_completed) add("scored", report.seconds, short_result);
  if (settings.is_passed) add(*settings.is_passed ? "passed" : "failed", report.seconds, short_result);
  return statements;
}

fs::path XapiQueue::FindFolder() {
  return host::FindUserDataFolder() / "xapi";
}

base::Status XapiQueue::Add(const XapiStatement& statement) {
  const fs::path path = folder_ / (statement.id + ".json");
  std::error_code failure;
  if (fs::exists(path, failure)) return {};
  return WriteSynced(path, statement.json);
}

std::vector<XapiStatement> XapiQueue::List() const {
  std::vector<XapiStatement> statements;
  for (const fs::path& path : ListFiles(folder_)) {
    if (auto statement = ReadStatement(path)) statements.push_back(std::move(*statement));
  }
  return statements;
}

std::vector<fs::path> XapiQueue::ListRefused() const {
  return ListFiles(folder_ / "refused");
}

base::Status XapiQueue::Remove(const std::string& id) {
  const fs::path path = folder_ / (id + ".json");
  std::error_code failure;
  fs::remove(path, failure);
  return failure ? base::Status(Unwritable(path)) : base::Status();
}

base::Status XapiQueue::Refuse(const XapiStatement& statement, const std::string& reason) {
  const fs::path refused = folder_ / "refused";
  if (auto status = WriteSynced(refused / (statement.id + ".txt"), reason + "\n"); !status.ok())
    return status;
  if (auto status = WriteSynced(refused / (statement.id + ".json"), statement.json); !status.ok())
    return status;
  return Remove(statement.id);
}

XapiErasure XapiQueue::Erase(const std::string& pseudonym) {
  XapiErasure erasure;
  for (const fs::path& folder : {folder_, folder_ / "refused"}) {
    std::error_code failure;
    std::vector<fs::path> files;
    for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end;
         entry.increment(failure))
      files.push_back(entry->path());
    if (failure && failure != std::errc::no_such_file_or_directory)
      erasure.left.push_back(folder.string() + ": " + failure.message());
    for (const fs::path& path : files) EraseFile(path, pseudonym, erasure);
  }
  return erasure;
}

}  // namespace trocar::report
