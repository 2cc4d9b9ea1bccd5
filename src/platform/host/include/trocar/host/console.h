// SPDX-License-Identifier: Apache-2.0
/// \file console.h  Output of commands for a person, in the person's language. Output for programs is printed as it is.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace trocar::host {

/// FormatNumber with the language's decimal mark: "9,81".
std::string ShownNumber(double value, int digits = 4);

/// With a fixed number of decimals and the language's decimal mark.
/// \param has_sign  "+1.20"
std::string ShownFixed(double value, int decimals, bool has_sign = false);

/// Part of a line to standard output. Its text may be of a file or a network: a line end in it becomes visible, and ends no
/// line.
void Print(std::string_view text);
/// A whole line to standard output, its text treated as by Print().
void PrintLine(std::string_view text = {});
/// A whole line to standard error, its text treated as by Print().
void PrintErrorLine(std::string_view text);
/// Several lines, of which each value was made printable where it was put in: FormatTable, FormatFields, WrapText and SaidText do that.
void PrintLines(std::string_view lines);
/// JSON that a program reads, with a line end.
void PrintJsonText(std::string_view json);

/// FormatTable with its heading translated, and with the language's decimal mark in cells that are numbers.
/// \param rows  the first is the heading, in English; tests/texts/list_console.py finds what a table's declaration has in it
std::string FormatShownTable(std::vector<std::vector<std::string>> rows);
void PrintTable(std::vector<std::vector<std::string>> rows);

/// FormatTable of what is named in the first column, which is translated, and how it is.
std::string FormatFields(std::vector<std::vector<std::string>> rows);

/// The pattern in the chosen language with its places filled. Spaces and line ends around it are no part of what is translated.
std::string SaidText(std::string_view pattern, std::initializer_list<std::string> values);

/// A value of Say as text; a floating-point number has to be given with its digits (ShownNumber).
template <typename Value>
std::string SaidValue(const Value& value) {
  static_assert(!std::is_floating_point_v<Value>, "say how many digits: ShownNumber, ShownFixed");
  if constexpr (std::is_integral_v<Value>) {
    return std::to_string(value);
  } else {
    return std::string(value);
  }
}

/// Prints to standard output: Say("{1} of {2} runs are done\n", done, all). The language of the values is the caller's care.
/// \param pattern  English; tests/texts/list_console.py finds it
template <typename... Values>
void Say(std::string_view pattern, const Values&... values) {
  PrintLines(SaidText(pattern, {SaidValue(values)...}));
}

}  // namespace trocar::host
