// SPDX-License-Identifier: Apache-2.0
/// \file serial_port.h  Serial lines, and pseudo-terminals that look like them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "trocar/device/ports.h"

namespace trocar::device {

/// 8 data bits, no parity, 1 stop bit, no flow control, DTR asserted.
///
/// \param path  such as /dev/ttyUSB0; better a name in /dev/serial/by-id, which stays when plugs change
/// \param baud  [bit/s] 2400 to 921600; 1200 is refused because it resets ATmega32u4 boards into their boot loader
/// \return kDeviceSettings for a speed or file that cannot be one, kDeviceLost where it does not open, kDeviceBusy where
///         another program holds it
base::Result<std::unique_ptr<Transport>> OpenSerialPort(const std::string& path, int baud);

/// A serial line found on this machine.
struct SerialPortInfo {
  std::string path;         ///< to open it by: the name in /dev/serial/by-id where there is one
  std::string device;       ///< "/dev/ttyUSB0"
  std::string description;  ///< "Polhemus LIBERTY", or what the by-id name says
};

/// USB serial lines, sorted by path. Built-in ones have to be named: the system lists those without a plug, too.
/// \param dev  folder to look in, /dev but in tests
std::vector<SerialPortInfo> ListSerialPorts(const std::string& dev = "/dev");

/// The far end of a pseudo-terminal: what an emulator reads and writes while a driver opens Path().
class PseudoTerminal : public Transport {
 public:
  /// \return kDeviceLost where the system has no more of them
  static base::Result<std::unique_ptr<PseudoTerminal>> Make();
  ~PseudoTerminal() override;
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  IoResult Read(std::span<char> buffer) noexcept override;
  IoResult Write(std::string_view bytes) noexcept override;
  const std::string& Path() const noexcept { return path_; }
  /// As if the plug were pulled.
  void Unplug() noexcept;

 private:
  PseudoTerminal(int master, int slave, std::string path)
      : master_(master), slave_(slave), path_(std::move(path)) {}
  int master_, slave_;  // the slave is held open so that a driver may come and go
  std::string path_;
};

}  // namespace trocar::device
