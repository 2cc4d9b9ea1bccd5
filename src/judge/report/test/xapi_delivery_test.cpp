// SPDX-License-Identifier: Apache-2.0
// Against a peer in a process of its own that speaks HTTP: learning_record_store.py.
#include "trocar/report/xapi_delivery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>
#include <utility>

#include "sample_reports.h"
#include "trocar/host/clock.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::report {
namespace {

using base::ErrorCode;

/// Of a report that has what is needed.
std::vector<XapiStatement> Make(const AttemptReport& report, const XapiSettings& settings) {
  const auto statements = MakeStatements(report, settings);
  EXPECT_TRUE(statements.ok()) << statements.error().Text();
  return statements.ok() ? *statements : std::vector<XapiStatement>();
}

/// Runs for as long as it lives.
class Peer {
 public:
  explicit Peer(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(),
                     {"python3", std::string(TROCAR_REPORT_TEST_FOLDER) + "/learning_record_store.py"});
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) return;
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(ends[1], STDOUT_FILENO);
      ::close(ends[0]);
      std::vector<char*> words;
      for (std::string& argument : arguments) words.push_back(argument.data());
      words.push_back(nullptr);
      ::execvp(words[0], words.data());
      ::_exit(127);
    }
    ::close(ends[1]);
    FILE* output = ::fdopen(ends[0], "r");
    if (std::fscanf(output, "%d", &port_) != 1) port_ = 0;
    std::fclose(output);
  }
  ~Peer() { Stop(); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void Stop() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
  }
  int Port() const { return port_; }

 private:
  pid_t process_ = -1;
  int port_ = 0;
};

class Delivery : public testing::Test {
 protected:
  void SetUp() override {
    settings_.credentials = "user:pass:word";
    settings_.answer_seconds = 1.0;
    settings_.first_pause = 0.02;
    settings_.most_pause = 0.2;
    settings_.give_up_seconds = 10;
    settings_.on_trouble = [this](const std::string& text) { troubles_.push_back(text); };
    for (const XapiStatement& statement :
         Make(test::MakeTaskReport(), {"https://training.hospital.example", true})) {
      ASSERT_TRUE(queue_.Add(statement).ok());
      ids_.insert(statement.id);
    }
  }

  /// How often each statement arrived at the peer, and how often it was new there.
  std::map<std::string, int> ReadNew() {
    std::map<std::string, int> times;
    const auto text = host::ReadFile(log_);
    std::istringstream lines(text.ok() ? *text : "");
    for (std::string line; std::getline(lines, line);) {
      const auto arrival = nlohmann::json::parse(line);
      times[arrival["id"]] += arrival["new"].get<bool>() ? 1 : 0;
    }
    return times;
  }
  void ExpectEachOnce() {
    const auto times = ReadNew();
    EXPECT_EQ(times.size(), ids_.size());
    for (const auto& [id, count] : times) EXPECT_EQ(count, 1) << id;
    EXPECT_TRUE(queue_.List().empty());
  }
  DeliveryReport Deliver(int port, const std::string& scheme = "http://127.0.0.1:") {
    const auto endpoint = ParseEndpoint(scheme + std::to_string(port) + "/xapi/");
    EXPECT_TRUE(endpoint.ok()) << endpoint.error().Text();
    const auto report = DeliverQueue(queue_, *endpoint, settings_);
    EXPECT_TRUE(report.ok()) << report.error().Text();
    return report.ok() ? *report : DeliveryReport();
  }

  trocar::test::TemporaryFolder folder_;
  std::string log_ = (folder_.Path() / "arrived").string();
  XapiQueue queue_{folder_.Path() / "queue"};
  DeliverySettings settings_;
  std::set<std::string> ids_;
  std::vector<std::string> troubles_;
};

TEST_F(Delivery, BringsEachStatementOnce) {
  Peer peer({log_});
  ASSERT_NE(peer.Port(), 0);
  const DeliveryReport report = Deliver(peer.Port());
  EXPECT_EQ(report.delivered, ids_.size());
  EXPECT_FALSE(report.failure.has_value());
  ExpectEachOnce();
}

TEST_F(Delivery, SurvivesEveryFaultOfThePeer) {
  Peer peer({log_, "500", "lost", "slow", "half", "503", "silent", "429", "half", "conflict", "lost"});
  ASSERT_NE(peer.Port(), 0);
  const DeliveryReport report = Deliver(peer.Port());
  EXPECT_EQ(report.delivered, ids_.size());
  EXPECT_EQ(report.waiting, 0u);
  EXPECT_GE(troubles_.size(), 8u);
  ExpectEachOnce();
}

TEST_F(Delivery, WaitsAsLongAsThePeerAsks) {
  Peer peer({log_, "503"});
  ASSERT_NE(peer.Port(), 0);
  const host::Stopwatch watch;
  Deliver(peer.Port());
  EXPECT_GE(watch.Seconds(), 1.0);
  ExpectEachOnce();
}

TEST_F(Delivery, KeepsEverythingWhileThePeerIsDownAndBringsItAfterwards) {
  int port = 0;
  {
    Peer gone({log_});
    port = gone.Port();
  }
  settings_.give_up_seconds = 0.3;
  const DeliveryReport report = Deliver(port);
  EXPECT_EQ(report.delivered, 0u);
  EXPECT_EQ(report.waiting, ids_.size());
  ASSERT_TRUE(report.failure.has_value());
  EXPECT_EQ(report.failure->code, ErrorCode::kXapiAway);
  Peer back({log_});
  settings_.give_up_seconds = 10;
  Deliver(back.Port());
  ExpectEachOnce();
}

TEST_F(Delivery, ASecondProcessBringsNothingTwice) {
  Peer peer({log_, "lost", "500", "lost"});
  // the first is killed after the peer has the statement and before it hears so
  const pid_t first = ::fork();
  if (first == 0) {
    settings_.first_pause = settings_.most_pause = 30;
    settings_.give_up_seconds = 100;
    Deliver(peer.Port());
    ::_exit(0);
  }
  const host::Stopwatch watch;
  while (ReadNew().empty() && watch.Seconds() < 60)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ::kill(first, SIGKILL);
  ::waitpid(first, nullptr, 0);
  EXPECT_EQ(queue_.List().size(), ids_.size());
  Deliver(peer.Port());
  ExpectEachOnce();
}

TEST_F(Delivery, SetsAsideWhatTheStoreWillNeverTake) {
  Peer peer({log_, "refuse"});
  const DeliveryReport report = Deliver(peer.Port());
  EXPECT_EQ(report.refused, 1u);
  EXPECT_EQ(report.delivered, ids_.size() - 1);
  ASSERT_EQ(queue_.ListRefused().size(), 1u);
  const auto reason =
      host::ReadFile(std::filesystem::path(queue_.ListRefused()[0]).replace_extension(".txt"));
  ASSERT_TRUE(reason.ok());
  EXPECT_EQ(*reason, "answer 400: no such verb\n");
}

TEST_F(Delivery, StopsAtWrongCredentialsAndAddress) {
  Peer peer({log_});
  settings_.credentials = "user:wrong";
  DeliveryReport report = Deliver(peer.Port());
  ASSERT_TRUE(report.failure.has_value());
  EXPECT_EQ(report.failure->code, ErrorCode::kXapiRefused);
  EXPECT_EQ(report.failure->message.find("wrong"), std::string::npos) << "no password in a message";
  EXPECT_EQ(report.waiting, ids_.size());
  settings_.credentials = "user:pass:word";
  const auto elsewhere = ParseEndpoint("http://localhost:" + std::to_string(peer.Port()) + "/other");
  ASSERT_TRUE(elsewhere.ok());
  const auto lost = DeliverQueue(queue_, *elsewhere, settings_);
  ASSERT_TRUE(lost.ok());
  EXPECT_EQ(lost->failure->code, ErrorCode::kXapiRefused);
}

TEST_F(Delivery, OneProgramAtATime) {
  Peer peer({log_, "500"});
  ASSERT_NE(peer.Port(), 0);
  // the first tells of its trouble in the middle of its work, and goes on when the second has been turned away
  std::promise<void> is_at_work, may_go_on;
  settings_.on_trouble = [&, is_first = true](const std::string&) mutable {
    if (!std::exchange(is_first, false)) return;
    is_at_work.set_value();
    may_go_on.get_future().wait();
  };
  std::thread first([&] { Deliver(peer.Port()); });
  const bool has_begun =
      is_at_work.get_future().wait_for(std::chrono::seconds(60)) == std::future_status::ready;
  EXPECT_TRUE(has_begun);
  if (has_begun) {
    const auto second = DeliverQueue(queue_, *ParseEndpoint("http://127.0.0.1:9"), {});
    EXPECT_FALSE(second.ok());
    if (!second.ok()) {
      EXPECT_EQ(second.error().code, ErrorCode::kFileInUse);
    }
  }
  may_go_on.set_value();
  first.join();
  ExpectEachOnce();
}

#if TROCAR_HAS_OPENSSL
TEST_F(Delivery, GoesOverTlsToWhomItCanTrustOnly) {
  const std::string certificate = (folder_.Path() / "cert.pem").string(),
                    key = (folder_.Path() / "key.pem").string();
  const std::string make =
      "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost -addext "
      "subjectAltName=DNS:localhost -keyout '" +
      key + "' -out '" + certificate + "' 2>/dev/null";
  if (std::system(make.c_str()) != 0) GTEST_SKIP() << "the openssl program is not installed";
  Peer peer({log_, "--tls", certificate, key});
  ASSERT_NE(peer.Port(), 0);
  // nobody has vouched for it
  DeliveryReport report = Deliver(peer.Port(), "https://localhost:");
  ASSERT_TRUE(report.failure.has_value());
  EXPECT_EQ(report.failure->code, ErrorCode::kXapiUnsafe);
  EXPECT_TRUE(ReadNew().empty());
  ::setenv("SSL_CERT_FILE", certificate.c_str(), 1);
  // another name than the certificate's
  report = Deliver(peer.Port(), "https://127.0.0.1:");
  EXPECT_EQ(report.failure.value_or(base::Error{}).code, ErrorCode::kXapiUnsafe);
  report = Deliver(peer.Port(), "https://localhost:");
  ::unsetenv("SSL_CERT_FILE");
  EXPECT_FALSE(report.failure.has_value()) << report.failure->Text();
  ExpectEachOnce();
}
#endif

TEST(ParseEndpoint, ReadsAddressesAndRefusesWhatIsUnsafe) {
  const auto code = [](const std::string& url) {
    const auto endpoint = ParseEndpoint(url);
    return endpoint.ok() ? ErrorCode::kNone : endpoint.error().code;
  };
  EXPECT_EQ(code("http://lrs.hospital.example/xapi"), ErrorCode::kXapiUnsafe);
  EXPECT_EQ(code("http://127.0.0.1.evil.example/"), ErrorCode::kXapiUnsafe);
  EXPECT_EQ(code("http://127.0.0.1:8080/xapi"), ErrorCode::kNone);
  EXPECT_EQ(code("http://[::1]:8080/xapi"), ErrorCode::kNone);
  for (const char* bad : {"", "lrs.example", "ftp://lrs.example", "https://", "https:///x", "https://a:b@c/",
                          "https://a:99999/", "https://a:/", "https://a b/", "https://a/\r\nX: y"})
    EXPECT_EQ(code(bad), ErrorCode::kUsage) << bad;
  const auto endpoint = ParseEndpoint("http://localhost:8080/data/xapi//");
  ASSERT_TRUE(endpoint.ok());
  EXPECT_EQ(endpoint->host, "localhost");
  EXPECT_EQ(endpoint->port, "8080");
  EXPECT_EQ(endpoint->path, "/data/xapi");
}

TEST(ReadCredentials, WantsAFileThatNobodyElseMayRead) {
  trocar::test::TemporaryFolder folder;
  const auto file = folder.Path() / "credentials";
  ASSERT_TRUE(host::WriteFile(file, "user:pass\n").ok());
  ASSERT_EQ(::chmod(file.c_str(), 0640), 0);
  EXPECT_EQ(ReadCredentials(file).error().code, ErrorCode::kXapiUnsafe);
  ASSERT_EQ(::chmod(file.c_str(), 0600), 0);
  const auto credentials = ReadCredentials(file);
  ASSERT_TRUE(credentials.ok());
  EXPECT_EQ(*credentials, "user:pass");
  ASSERT_TRUE(host::WriteFile(file, "no colon").ok());
  ASSERT_EQ(::chmod(file.c_str(), 0600), 0);
  EXPECT_EQ(ReadCredentials(file).error().code, ErrorCode::kUsage);
  EXPECT_EQ(ReadCredentials(folder.Path() / "missing").error().code, ErrorCode::kFileMissing);
}

}  // namespace
}  // namespace trocar::report
