// SPDX-License-Identifier: Apache-2.0
/// \file printable_output.h  Standard output and standard error as a fence: nothing that a file, a network or a person chose can
/// steer the terminal.
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace trocar::host {

/// `text` of any number of lines for a terminal, none of it lost: line ends and tabs stay; other control characters, marks that
/// change the writing direction and bytes that are no UTF-8 become visible. ASCII is written \\xNN; what is beyond it \\uNNNN,
/// which in JSON is the same text.
std::string PrintableText(std::string_view text);

/// PrintableText() of a value within a line, which must not forge another line: line ends become \\x0A, too.
std::string PrintableLine(std::string_view text);

/// While it lives, all that goes to stdout, stderr, std::cout, std::cerr and std::clog passes PrintableText, whoever writes it and
/// wherever it goes: a pipe may end in a terminal, too. Buffering, errors of writing and descriptors 1 and 2 stay as they are.
/// At most one lives, made before threads print and ended after.
class PrintableOutput {
 public:
  PrintableOutput();
  ~PrintableOutput();
  PrintableOutput(const PrintableOutput&) = delete;
  PrintableOutput& operator=(const PrintableOutput&) = delete;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

/// Sequences of our own that steer the terminal, such as "\033[K", which nothing else may.
/// \param stream  stdout or stderr
void WriteControl(std::FILE* stream, std::string_view sequence);

}  // namespace trocar::host
