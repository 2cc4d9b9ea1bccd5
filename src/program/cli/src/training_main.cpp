// SPDX-License-Identifier: Apache-2.0
#include "trocar/cli/parts.h"

int main(int argc, char** argv) {
  return trocar::cli::RunCommandOf(trocar::cli::TrainingCommands(), argc, argv);
}
