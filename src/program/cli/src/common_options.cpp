// SPDX-License-Identifier: Apache-2.0
#include "common_options.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>

namespace trocar::cli {

CLI::Option* AddThreadsOption(CLI::App& command, int& threads, const char* about) {
  return command.add_option("--threads", threads, about)
      ->check(CLI::Range(1, 256))
      ->type_name("T")
      ->capture_default_str();
}

CLI::Option* AddJsonFlag(CLI::App& command, bool& is_json, const char* about) {
  return command.add_flag("--json", is_json, about);
}

CLI::Option* AddSizeOption(CLI::App& command, std::string& size, const char* about) {
  return command.add_option("--size", size, about)->type_name("WxH")->capture_default_str();
}

CLI::Option* AddCacheOption(CLI::App& command, std::string& cache, const char* about) {
  return command.add_option("--cache", cache, about)->type_name("DIR");
}

}  // namespace trocar::cli
