// SPDX-License-Identifier: Apache-2.0
#include "trocar/cli/run_command.h"

int main(int argc, char** argv) {
  return trocar::cli::RunCommand(argc, argv);
}
