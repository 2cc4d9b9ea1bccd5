// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "polhemus/polhemus_layout.h"
#include "trocar/device/emulator.h"

namespace trocar::device {
namespace {

/// After so long a silence of the caller's clock the records in between are not made up [s].
constexpr double kLongestStep = 0.25;

/// Numbers of "1,2,4,1" or "1,1.0,0,0"; what is none ends the list.
std::vector<double> ReadList(std::string_view text) {
  std::vector<double> numbers;
  while (!text.empty()) {
    double value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc()) break;
    numbers.push_back(value);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (!text.starts_with(',')) break;
    text.remove_prefix(1);
  }
  return numbers;
}

/// FASTRAK, LIBERTY or PATRIOT: their commands, output lists, units, hemispheres and rates.
class PolhemusEmulator : public Emulator {
 public:
  explicit PolhemusEmulator(PolhemusEmulation emulation) : emulation_(std::move(emulation)) { PowerOn(); }

  void Receive(std::string_view bytes) override;
  std::string Advance(double time) override;

 private:
  struct Station {
    std::vector<int> items{2, 4, 1};  // as after power-on
    math::Vec3 hemisphere{1, 0, 0};
  };

  void PowerOn() {
    stations_.assign(static_cast<std::size_t>(emulation_.stations), {});
    is_binary_ = is_metric_ = is_continuous_ = false;
  }
  bool EndsWithReturn(char command) const noexcept;
  void Obey(std::string_view command);
  void ObeyShared(char command, const std::vector<double>& list);
  std::string FormatStation(int station, double time);
  double Period() const noexcept;

  PolhemusEmulation emulation_;
  std::vector<Station> stations_;
  bool is_binary_ = false, is_metric_ = false, is_continuous_ = false;
  std::string command_;  // begun
  std::string due_;      // answers
  double time_ = 0;      // [s]
  double next_ = 0;      // continuous record [s]
  std::uint32_t frame_ = 0;
};

/// FASTRAK obeys single letters at once, except those with arguments; LIBERTY waits for a return after all but P.
bool PolhemusEmulator::EndsWithReturn(char command) const noexcept {
  if (!IsFastrak(emulation_.format)) return command != 'P';
  return std::string_view("OHlxvAReIB").find(command) != std::string_view::npos;
}

void PolhemusEmulator::Receive(std::string_view bytes) {
  constexpr std::size_t kLongest = 200;
  for (const char byte : bytes) {
    if (byte == '\n' || (byte == '\r' && command_.empty())) continue;
    if (byte != '\r') command_ += byte;
    const bool is_whole = byte == '\r' || !EndsWithReturn(command_.front());
    if (is_whole) Obey(command_);
    if (is_whole || command_.size() > kLongest) command_.clear();
  }
}

void PolhemusEmulator::Obey(std::string_view command) {
  const char letter = command.front();
  const std::vector<double> list = ReadList(command.substr(1));
  const bool is_fastrak = IsFastrak(emulation_.format);
  switch (letter) {
    case 'P':
      // LIBERTY also stops sending
      if (!is_fastrak) is_continuous_ = false;
      for (int station = 1; station <= emulation_.stations; ++station) due_ += FormatStation(station, time_);
      break;
    case 'C':
      is_continuous_ = true;
      next_ = time_;
      break;
    case 'c':
      is_continuous_ = false;
      break;
    case 'F':
      is_binary_ = !is_fastrak && !list.empty() && list[0] == 1.0;
      break;
    case 'f':
      is_binary_ = true;
      break;
    case 'U':
      is_metric_ = !is_fastrak && !list.empty() && list[0] == 1.0;
      break;
    case 'u':
      is_metric_ = true;
      break;
    case 'W':
      PowerOn();
      break;
    default:
      ObeyShared(letter, list);
  }
}

/// Commands whose first argument is a station.
void PolhemusEmulator::ObeyShared(char command, const std::vector<double>& list) {
  if (list.empty() || !(list[0] >= 1.0 && list[0] <= static_cast<double>(stations_.size()))) return;
  Station& station = stations_[static_cast<std::size_t>(list[0]) - 1];
  if (command == 'O') station.items.assign(list.begin() + 1, list.end());
  if (command == 'H' && list.size() == 4)
    station.hemisphere = math::Normalized(math::Vec3{list[1], list[2], list[3]});
}

std::string PolhemusEmulator::FormatStation(int number, double time) {
  const Station& station = stations_[static_cast<std::size_t>(number - 1)];
  // LIBERTY in ASCII is not spoken here: no driver of ours asks for it
  if (!IsFastrak(emulation_.format) && !is_binary_) return {};
  const math::Pose pose = emulation_.motion(number - 1, time);
  TrackerRecord record{number, ' ', pose.translation, pose.rotation};
  if (math::Dot(record.position, station.hemisphere) < 0.0) record.position = -record.position;
  PolhemusFormat format = emulation_.format;
  if (IsFastrak(format)) format = is_binary_ ? PolhemusFormat::kFastrakBinary : PolhemusFormat::kFastrakAscii;
  return FormatRecord(format, station.items, record, is_metric_, static_cast<std::uint32_t>(1e3 * time),
                      ++frame_);
}

/// Between two records of one station [s].
double PolhemusEmulator::Period() const noexcept {
  if (emulation_.format == PolhemusFormat::kPatriot) return 1.0 / 60.0;
  if (emulation_.format == PolhemusFormat::kLiberty) return 1.0 / 240.0;
  return emulation_.stations / 120.0;
}

std::string PolhemusEmulator::Advance(double time) {
  time_ = time;
  std::string bytes = std::exchange(due_, {});
  if (next_ < time - kLongestStep) next_ = time;
  for (; is_continuous_ && next_ <= time; next_ += Period()) {
    for (int station = 1; station <= emulation_.stations; ++station) bytes += FormatStation(station, next_);
  }
  return bytes;
}

}  // namespace

std::unique_ptr<Emulator> MakePolhemusEmulator(PolhemusEmulation emulation) {
  emulation.stations = std::clamp(emulation.stations, 1, kChannelCount);
  return std::make_unique<PolhemusEmulator>(std::move(emulation));
}

}  // namespace trocar::device
