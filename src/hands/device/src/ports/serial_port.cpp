// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/serial_port.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "file_transport.h"

namespace trocar::device {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

constexpr std::pair<int, speed_t> kSpeeds[] = {
    {2400, B2400},   {4800, B4800},     {9600, B9600},     {19200, B19200},   {38400, B38400},
    {57600, B57600}, {115200, B115200}, {230400, B230400}, {460800, B460800}, {921600, B921600}};

base::Result<speed_t> FindSpeed(int baud) {
  for (const auto& [value, speed] : kSpeeds) {
    if (value == baud) return speed;
  }
  return base::Error{
      ErrorCode::kDeviceSettings,
      std::to_string(baud) +
          " baud is no speed for a tracker or sensor; use one of 2400, 4800, 9600, 19200, 38400, "
          "57600, 115200, 230400, 460800, 921600, as its switches say"};
}

/// Bytes as they are, at that speed; a read gives what is there.
bool MakeRaw(int file, speed_t speed) noexcept {
  termios settings{};
  if (::tcgetattr(file, &settings) != 0) return false;
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  // with VMIN 0 a read of 0 bytes could mean "nothing yet" as well as "hung up"
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  ::cfsetispeed(&settings, speed);
  ::cfsetospeed(&settings, speed);
  return ::tcsetattr(file, TCSANOW, &settings) == 0;
}

base::Error OpenError(const std::string& path) {
  if (errno == EACCES || errno == EPERM) {
    return {ErrorCode::kDeviceLost,
            path +
                " may not be opened: add yourself to its group (sudo usermod -aG dialout "
                "$USER), then log in again"};
  }
  if (errno == EBUSY) return {ErrorCode::kDeviceBusy, path + " is used by another program; close it"};
  return {ErrorCode::kDeviceLost, path + ": " + std::strerror(errno) + "; is it plugged in and switched on?"};
}

/// "usb-Polhemus_LIBERTY-if00" -> "Polhemus LIBERTY"
std::string Describe(std::string name) {
  if (name.starts_with("usb-")) name.erase(0, 4);
  if (const auto end = name.rfind("-if"); end != std::string::npos) name.resize(end);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

}  // namespace

base::Result<std::unique_ptr<Transport>> OpenSerialPort(const std::string& path, int baud) {
  const base::Result<speed_t> speed = FindSpeed(baud);
  if (!speed) return speed.error();
  const int file = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return OpenError(path);
  auto transport = std::make_unique<FileTransport>(file);
  if (::isatty(file) == 0) {
    return base::Error{ErrorCode::kDeviceSettings,
                       path + " is no serial line; trocar devices list shows them"};
  }
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    return base::Error{ErrorCode::kDeviceBusy, path + " is used by another program; close it"};
  }
  if (!MakeRaw(file, *speed)) return OpenError(path);
  // boards with native USB send nothing before DTR; a pseudo-terminal has no such line, which does no harm
  int lines = TIOCM_DTR | TIOCM_RTS;
  ::ioctl(file, TIOCMBIS, &lines);
  ::tcflush(file, TCIOFLUSH);
  return std::unique_ptr<Transport>(std::move(transport));
}

std::vector<SerialPortInfo> ListSerialPorts(const std::string& dev) {
  std::vector<SerialPortInfo> ports;
  std::error_code failure;
  for (const fs::directory_entry& link : fs::directory_iterator(fs::path(dev) / "serial/by-id", failure)) {
    const fs::path device = fs::weakly_canonical(link.path(), failure);
    ports.push_back({link.path().string(), device.string(), Describe(link.path().filename().string())});
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(dev, failure)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("ttyUSB") && !name.starts_with("ttyACM")) continue;
    const std::string path = entry.path().string();
    if (std::none_of(ports.begin(), ports.end(),
                     [&](const SerialPortInfo& port) { return port.device == path; }))
      ports.push_back({path, path, "serial line"});
  }
  std::sort(ports.begin(), ports.end(),
            [](const SerialPortInfo& a, const SerialPortInfo& b) { return a.path < b.path; });
  return ports;
}

base::Result<std::unique_ptr<PseudoTerminal>> PseudoTerminal::Make() {
  const auto fail = [](int file) {
    const std::string why = std::strerror(errno);
    if (file >= 0) ::close(file);
    return base::Error{ErrorCode::kDeviceLost,
                       "no pseudo-terminal can be made: " + why + "; is /dev/pts mounted?"};
  };
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  if (master < 0) return fail(-1);
  std::array<char, 128> name{};
  if (::grantpt(master) != 0 || ::unlockpt(master) != 0 || ::ptsname_r(master, name.data(), name.size()) != 0)
    return fail(master);
  const int slave = ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (slave < 0 || !MakeRaw(slave, B115200)) {
    if (slave >= 0) ::close(slave);
    return fail(master);
  }
  return std::unique_ptr<PseudoTerminal>(new PseudoTerminal(master, slave, name.data()));
}

PseudoTerminal::~PseudoTerminal() {
  Unplug();
}

void PseudoTerminal::Unplug() noexcept {
  for (int* file : {&master_, &slave_}) {
    if (*file >= 0) ::close(*file);
    *file = -1;
  }
}

IoResult PseudoTerminal::Read(std::span<char> buffer) noexcept {
  const ssize_t got = master_ < 0 ? 0 : ::read(master_, buffer.data(), buffer.size());
  return {got > 0 ? static_cast<std::size_t>(got) : 0, master_ < 0};
}

IoResult PseudoTerminal::Write(std::string_view bytes) noexcept {
  const ssize_t sent = master_ < 0 ? 0 : ::write(master_, bytes.data(), bytes.size());
  return {sent > 0 ? static_cast<std::size_t>(sent) : 0, master_ < 0};
}

}  // namespace trocar::device
