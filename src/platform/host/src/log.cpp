// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "trocar/host/printable_output.h"

namespace trocar::host {
namespace {

spdlog::level::level_enum ToSpdlog(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      break;
  }
  return spdlog::level::err;
}

spdlog::logger& GetLogger() {
  static spdlog::logger logger = [] {
    spdlog::logger made("trocar", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
    made.set_pattern("trocar: %^%l%$: %v");
    return made;
  }();
  return logger;
}

}  // namespace

void SetLogLevel(LogLevel level) {
  GetLogger().set_level(ToSpdlog(level));
}

void Log(LogLevel level, std::string_view text) {
  GetLogger().log(ToSpdlog(level), "{}", PrintableLine(text));
}

}  // namespace trocar::host
