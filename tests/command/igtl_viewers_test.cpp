// SPDX-License-Identifier: Apache-2.0
// Viewers over OpenIGTLink that connect to a running trocar and never read. Slow: what is promised is ten seconds.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include "command_fixture.h"

namespace trocar {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr int kPlaces = 8;
constexpr auto kPromised = seconds(13);  // docs/devices.md: 10, and what systems buffer until it shows
constexpr auto kLateness = seconds(2);   // of a shared machine

class Viewer {
 public:
  explicit Viewer(int port) : file_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_connected_ = ::connect(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~Viewer() { ::close(file_); }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  bool IsConnected() const { return is_connected_; }
  /// Reads what is there. \return bytes
  std::size_t Read() {
    std::array<char, 65536> bytes;
    std::size_t all = 0;
    for (ssize_t count; (count = ::recv(file_, bytes.data(), bytes.size(), MSG_DONTWAIT)) > 0;)
      all += static_cast<std::size_t>(count);
    return all;
  }

 private:
  int file_;
  bool is_connected_ = false;
};

/// Sockets that a process holds: its listener, and one for each viewer that has a place.
int CountSockets(int process) {
  int count = 0;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(process) + "/fd", failure))
    count += fs::read_symlink(entry.path(), failure).string().starts_with("socket:") ? 1 : 0;
  return count;
}

class IgtlViewersSlow : public Command {
 protected:
  IgtlViewersSlow()
      : server_({TROCAR_PROGRAM, "simulate", Source("scenes/demonstration.json"), "--ticks", "1000000",
                 "--igtl", "0"}) {
    const std::string before = "localhost:";
    for (const auto until = Clock::now() + seconds(60); port_ == 0 && Clock::now() < until;) {
      const std::string said = server_.Err();
      const std::size_t at = said.find(before), end = said.find('\n', at);
      if (at != std::string::npos && end != std::string::npos)
        port_ = std::stoi(said.substr(at + before.size()));
      std::this_thread::sleep_for(milliseconds(20));
    }
  }
  ~IgtlViewersSlow() override { server_.Signal(SIGKILL); }

  std::vector<std::unique_ptr<Viewer>> Connect(int count) const {
    std::vector<std::unique_ptr<Viewer>> viewers;
    for (int i = 0; i < count; ++i) {
      viewers.push_back(std::make_unique<Viewer>(port_));
      EXPECT_TRUE(viewers.back()->IsConnected());
    }
    return viewers;
  }
  /// \return whether it came to that
  bool WaitForSockets(int wanted, Clock::time_point until) {
    while (CountSockets(server_.Id()) != wanted && Clock::now() < until)
      std::this_thread::sleep_for(milliseconds(20));
    return CountSockets(server_.Id()) == wanted;
  }

  test::Process server_;
  int port_ = 0;
};

TEST_F(IgtlViewersSlow, ThatNeverReadKeepNoPlaceBeyondWhatIsPromised) {
  ASSERT_NE(port_, 0) << server_.Err();
  const int alone = CountSockets(server_.Id());
  const auto deaf = Connect(kPlaces);
  ASSERT_TRUE(WaitForSockets(alone + kPlaces, Clock::now() + seconds(10)))
      << "the control: all places are taken";
  const auto taken = Clock::now();
  EXPECT_TRUE(WaitForSockets(alone, taken + kPromised + kLateness))
      << CountSockets(server_.Id()) - alone << " of " << kPlaces << " places are still taken";
  const auto waited = Clock::now() - taken;
  EXPECT_GT(waited, seconds(5)) << "nobody is let go for a hiccup";
  // and whoever reads gets them all, and keeps them
  const auto readers = Connect(kPlaces);
  std::vector<std::size_t> heard(readers.size(), 0);
  for (const auto until = Clock::now() + kPromised + kLateness; Clock::now() < until;) {
    for (std::size_t i = 0; i < readers.size(); ++i) heard[i] += readers[i]->Read();
    std::this_thread::sleep_for(milliseconds(5));
  }
  EXPECT_EQ(CountSockets(server_.Id()), alone + kPlaces);
  for (const std::size_t bytes : heard) EXPECT_GT(bytes, 10'000u);
  EXPECT_FALSE(server_.HasEnded()) << server_.Err();
}

}  // namespace
}  // namespace trocar
