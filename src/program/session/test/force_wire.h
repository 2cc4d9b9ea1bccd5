// SPDX-License-Identifier: Apache-2.0
/// \file force_wire.h  The emulated device's end of a wire: which forces arrive, and when.
///
/// A pseudo-terminal is what an emulated serial device is served on; the kernel hands its bytes over through a worker of
/// ordinary priority, which on a busy machine waits its turn. A socket hands them over at once, as the driver of a
/// real serial line does.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sched.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "trocar/device/simulated_force_device.h"
#include "trocar/host/clock.h"

namespace trocar::session {

enum class WireKind { kTerminal, kSocket };
inline const char* WireName(WireKind kind) {
  return kind == WireKind::kTerminal ? "pseudo-terminal" : "socket";
}

class ForceWire {
 public:
  enum class Got { kNothing, kZero, kForce, kClosed };

  explicit ForceWire(WireKind kind) {
    int ends[2] = {-1, -1};
    if (kind == WireKind::kTerminal) {
      ::openpty(&ends[0], &ends[1], nullptr, nullptr, nullptr);
      termios raw{};
      ::tcgetattr(ends[1], &raw);
      ::cfmakeraw(&raw);
      ::tcsetattr(ends[1], TCSANOW, &raw);
    } else {
      ::socketpair(AF_UNIX, SOCK_STREAM, 0, ends);
    }
    device_ = ends[0], host_ = ends[1];
    for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);
    ::fcntl(host_, F_SETFL, ::fcntl(host_, F_GETFL) | O_NONBLOCK);
  }
  ForceWire(const ForceWire&) = delete;
  ForceWire& operator=(const ForceWire&) = delete;
  ~ForceWire() {
    CloseHost();
    ::close(device_);
  }

  /// The simulator's end, non-blocking.
  int Host() const { return host_; }
  /// Once another process has it.
  void CloseHost() {
    if (host_ >= 0) ::close(host_);
    host_ = -1;
  }

  /// The next force on the wire, waited for up to `seconds`.
  Got Next(double seconds) {
    const host::Stopwatch watch;
    std::int64_t awake = host::NowNanoseconds();
    for (;;) {
      while (bytes_.size() >= device::SimulatedForceFrame::kBytes) {
        // synchronise on the frame's mark
        if (std::memcmp(bytes_.data(), "TRFC", 4) != 0) {
          bytes_.erase(bytes_.begin());
          continue;
        }
        float force[3];
        std::memcpy(force, bytes_.data() + 8, sizeof force);
        bytes_.erase(bytes_.begin(), bytes_.begin() + device::SimulatedForceFrame::kBytes);
        size_ = math::Norm(math::Vec3{force[0], force[1], force[2]});
        return force[0] == 0.0F && force[1] == 0.0F && force[2] == 0.0F ? Got::kZero : Got::kForce;
      }
      if (watch.Seconds() > seconds) return Got::kNothing;
      pollfd waiting{device_, POLLIN, 0};
      ::poll(&waiting, 1, 1);
      arrived_ = host::NowNanoseconds();
      longest_absence_ = std::max(longest_absence_, arrived_ - awake - 1'000'000);
      awake = arrived_;
      char read[4096];
      const ssize_t size = (waiting.revents & POLLIN) != 0 ? ::read(device_, read, sizeof read) : 0;
      if (size > 0) bytes_.insert(bytes_.end(), read, read + size);
      const bool is_at_end = size == 0 && (waiting.revents & (POLLIN | POLLHUP)) != 0;
      if (size < 0 || is_at_end) return Got::kClosed;
    }
  }
  /// Of the last force [N].
  double Size() const { return size_; }
  /// Time at which the last force arrived [ns].
  std::int64_t Arrived() const { return arrived_; }
  /// How long the reader itself, which wakes every millisecond, was not let run since ForgetAbsence() [s]: the machine's own
  /// part in what is measured.
  double LongestAbsence() const { return 1e-9 * static_cast<double>(longest_absence_); }
  void ForgetAbsence() { longest_absence_ = 0; }

  /// How often a fault is repeated in this run.
  static int Repeats() {
    const char* wanted = std::getenv("TROCAR_REPEATS");
    return wanted != nullptr ? std::max(1, std::atoi(wanted)) : 2;
  }
  /// The calling thread reads before everybody else, where that is permitted.
  static bool ReadInRealTime() {
    sched_param parameters{};
    parameters.sched_priority = sched_get_priority_min(SCHED_FIFO) + 40;
    return ::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
  }

 private:
  int device_ = -1, host_ = -1;
  std::vector<char> bytes_;
  double size_ = 0;
  std::int64_t arrived_ = 0, longest_absence_ = 0;
};

/// Times until zero, and how many of them the machine itself has a part in: the reader goes before everybody else and
/// wakes every millisecond; where it was held up, so was everybody.
class ZeroTimes {
 public:
  static constexpr double kAbsent = 0.001;    // of the reader, that counts [s]
  static constexpr double kGenerous = 0.100;  // that every machine keeps where 30 ms are promised [s]
  static constexpr double kUsual = 0.030;

  void Add(double seconds, double reader_absence) {
    (reader_absence > kAbsent ? disturbed_ : times_).push_back(seconds);
    longest_absence_ = std::max(longest_absence_, reader_absence);
  }
  /// Prints the percentiles and judges: in every run by a limit that a busy machine keeps as well, and with
  /// TROCAR_SLOW_TESTS=1, on a quiet machine, by what is promised [s].
  void ReportAndJudge(const std::string& what, double promised = kUsual) {
    const double longest = Report(what), generous = kGenerous * std::max(1.0, promised / kUsual);
    EXPECT_LE(longest, generous) << what;
    for (const double seconds : disturbed_) EXPECT_LE(seconds, generous + longest_absence_) << what;
    if (std::getenv("TROCAR_SLOW_TESTS") != nullptr) {
      EXPECT_LE(longest, promised) << what;
    }
  }
  /// Prints the percentiles. \return the longest of those in which the machine let the reader run [s]
  double Report(const std::string& what) {
    std::vector<double> all = times_;
    all.insert(all.end(), disturbed_.begin(), disturbed_.end());
    std::sort(all.begin(), all.end());
    const auto at = [&](double share) {
      return 1e3 * all[std::min(all.size() - 1, static_cast<std::size_t>(share * all.size()))];
    };
    const double longest = times_.empty() ? 0.0 : *std::max_element(times_.begin(), times_.end());
    std::printf(
        "%s: zero at the device after %.2f ms (median of %zu), %.2f (p99), %.2f (longest); %.2f the longest "
        "of the "
        "%zu in which the reader itself was not held up for more than %.0f ms (%.2f at most)\n",
        what.c_str(), at(0.5), all.size(), at(0.99), at(1.0), 1e3 * longest, times_.size(), 1e3 * kAbsent,
        1e3 * longest_absence_);
    std::fflush(stdout);
    return longest;
  }

 private:
  std::vector<double> times_, disturbed_;
  double longest_absence_ = 0;
};

/// The loop's longest period in each run, apart where the machine itself did not run for a moment.
class LoopPeriods {
 public:
  /// \param longest          period in a run [s]
  /// \param machine_absence  longest of the machine in that run [s]
  void Add(double longest, double machine_absence) {
    double& known = machine_absence > kMostAbsence ? disturbed_ : undisturbed_;
    known = std::max(known, longest);
    disturbances_ += machine_absence > kMostAbsence ? 1 : 0;
    ++runs_;
    absence_ = std::max(absence_, machine_absence);
    excess_ = std::max(excess_, longest - machine_absence);
  }
  /// Prints and judges, in every run and with TROCAR_SLOW_TESTS=1 as above: a period of a millisecond may be 5 ms late, and
  /// as much more as the machine was away.
  void ReportAndJudge(const std::string& what) const {
    std::printf(
        "%s: longest period of the loop %.2f ms; %.2f in the %d of %d runs in which the machine itself was "
        "away for more than "
        "%.1f ms (%.2f at most)\n",
        what.c_str(), 1e3 * undisturbed_, 1e3 * disturbed_, disturbances_, runs_, 1e3 * kMostAbsence,
        1e3 * absence_);
    std::fflush(stdout);
    EXPECT_LE(undisturbed_, ZeroTimes::kGenerous) << what;
    if (std::getenv("TROCAR_SLOW_TESTS") != nullptr) {
      EXPECT_LE(undisturbed_, 0.001 + 0.005) << what;
      EXPECT_LE(excess_, 0.001 + 0.005) << what;
    }
  }

 private:
  static constexpr double kMostAbsence = 0.0005;  // [s]
  double undisturbed_ = 0, disturbed_ = 0, absence_ = 0, excess_ = 0;
  int disturbances_ = 0, runs_ = 0;
};

}  // namespace trocar::session
