// SPDX-License-Identifier: Apache-2.0
/// \file help_texts.h  The texts of all commands' help, for the test that every one has been translated.
#pragma once

#include <functional>
#include <string>

namespace trocar::cli {

/// Gets a text and returns what is to stand in its place.
using TextVisitor = std::function<std::string(const std::string&)>;

/// Visits every description, note, group, placeholder and range that `trocar ... --help` prints, in English.
void ListHelpTexts(const TextVisitor& visit);

}  // namespace trocar::cli
