// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/xapi_delivery.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <random>
#include <thread>

#include "http_client.h"
#include "trocar/host/clock.h"
#include "trocar/host/file_lock.h"
#include "trocar/host/safe_file.h"

namespace trocar::report {
namespace {

constexpr std::size_t kMostCredentials = 4096;  // [bytes]
constexpr std::size_t kMostReason = 300;        // of an answer that is kept [bytes]

/// What an answer means for a statement.
enum class Meaning { kArrived, kRefused, kStop, kLater };

Meaning MeaningOf(int status) {
  // 409: there is a statement of this id, which an earlier try brought
  if ((status >= 200 && status < 300) || status == 409) return Meaning::kArrived;
  if (status == 408 || status == 429 || status >= 500) return Meaning::kLater;
  if (status == 400 || status == 413 || status == 422) return Meaning::kRefused;
  // redirects, credentials, address: no statement will fare better
  return Meaning::kStop;
}

base::Error ExplainStop(const HttpAnswer& answer) {
  const std::string status = "the learning record store answered " + std::to_string(answer.status) + "; ";
  if (answer.status == 401 || answer.status == 403)
    return {base::ErrorCode::kXapiRefused,
            status +
                "check user and password in the credentials file, and that the account may write statements"};
  return {base::ErrorCode::kXapiRefused,
          status + "check --endpoint: it is the address before \"/statements\""};
}

std::string Shorten(std::string text) {
  if (text.size() > kMostReason) text.resize(kMostReason);
  return text;
}

/// Pauses that grow, each at random from half of it on, so that many machines do not come back at once.
class BackOff {
 public:
  explicit BackOff(const DeliverySettings& settings) : settings_(settings), pause_(settings.first_pause) {}
  void Reset() { pause_ = settings_.first_pause; }
  double Next() {
    const double pause = pause_ * std::uniform_real_distribution<double>(0.5, 1.0)(random_);
    pause_ = std::min(2 * pause_, settings_.most_pause);
    return pause;
  }

 private:
  const DeliverySettings& settings_;
  double pause_;
  std::mt19937 random_{std::random_device()()};
};

}  // namespace

base::Result<std::string> ReadCredentials(const std::filesystem::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0)
    return base::Error{base::ErrorCode::kFileMissing,
                       path.string() + ": there is no such file with user:password"};
  if ((info.st_mode & 077) != 0)
    return base::Error{base::ErrorCode::kXapiUnsafe,
                       path.string() + " may be read by others; run: chmod 600 " + path.string()};
  auto text = host::ReadFile(path, kMostCredentials);
  if (!text.ok()) return text.error();
  while (!text->empty() && (text->back() == '\n' || text->back() == '\r')) text->pop_back();
  if (text->find(':') == std::string::npos || text->find('\n') != std::string::npos)
    return base::Error{base::ErrorCode::kUsage, path.string() + " must hold one line, user:password"};
  return std::move(*text);
}

base::Result<DeliveryReport> DeliverQueue(XapiQueue& queue, const Endpoint& endpoint,
                                          const DeliverySettings& settings) {
  auto lock = host::FileLock::Take(queue.Folder() / "delivery.lock");
  if (!lock.ok()) return lock.error();
  DeliveryReport report;
  BackOff back_off(settings);
  host::Stopwatch since_success;
  std::vector<XapiStatement> waiting = queue.List();
  std::size_t next = 0;
  while (next < waiting.size()) {
    const XapiStatement& statement = waiting[next];
    const auto answer =
        PostStatement(endpoint, statement.json, settings.credentials, settings.answer_seconds);
    if (!answer.ok() && answer.error().code == base::ErrorCode::kXapiUnsafe) {
      report.failure = answer.error();
      break;
    }
    const Meaning meaning = answer.ok() ? MeaningOf(answer->status) : Meaning::kLater;
    if (meaning == Meaning::kStop) {
      report.failure = ExplainStop(*answer);
      break;
    }
    if (meaning == Meaning::kLater) {
      const base::Error why =
          answer.ok() ? base::Error{base::ErrorCode::kXapiAway, "the learning record store answered " +
                                                                    std::to_string(answer->status) +
                                                                    "; it is tried again later"}
                      : answer.error();
      const double pause = std::max(back_off.Next(), answer.ok() ? answer->retry_after : 0);
      if (since_success.Seconds() + pause > settings.give_up_seconds) {
        report.failure = why;
        break;
      }
      if (settings.on_trouble) settings.on_trouble(why.Text());
      std::this_thread::sleep_for(std::chrono::duration<double>(pause));
      continue;
    }
    const base::Status taken_away = meaning == Meaning::kArrived
                                        ? queue.Remove(statement.id)
                                        : queue.Refuse(statement, "answer " + std::to_string(answer->status) +
                                                                      ": " + Shorten(answer->body));
    if (!taken_away.ok()) {
      report.failure = taken_away.error();
      break;
    }
    ++(meaning == Meaning::kArrived ? report.delivered : report.refused);
    ++next;
    since_success.Restart();
    back_off.Reset();
    // what was added meanwhile
    if (next == waiting.size()) waiting = queue.List(), next = 0;
  }
  report.waiting = queue.List().size();
  return report;
}

}  // namespace trocar::report
