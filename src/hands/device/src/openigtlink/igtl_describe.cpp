// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <utility>

#include "trocar/device/igtl.h"
#include "trocar/host/printable.h"
#include "trocar/host/translate.h"

namespace trocar::device {
namespace {

using host::Mark;

/// Names of one sentence; further ones are counted.
constexpr std::size_t kMostNames = 4;

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string Hexadecimal(std::uint64_t word) {
  char text[32];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(word));
  return text;
}

/// English, as TranslateComposed finds the pattern again in it.
std::string Fill(std::string_view pattern, std::initializer_list<std::string> values) {
  std::string filled;
  for (std::size_t at = 0; at < pattern.size(); ++at) {
    const std::size_t place =
        pattern[at] == '{' ? static_cast<std::size_t>(pattern[at + 1] - '1') : values.size();
    if (place >= values.size()) {
      filled += pattern[at];
      continue;
    }
    filled += values.begin()[place];
    at += 2;
  }
  return filled;
}

template <std::size_t kSize>
std::string Text(const std::array<char, kSize>& room) {
  return host::Printable(
      {room.data(), static_cast<std::size_t>(std::find(room.begin(), room.end(), '\0') - room.begin())});
}

std::string Title(const IgtlSeen& seen) {
  return Text(seen.type) + " \"" + Text(seen.name) + "\"";
}

/// Why they do not count and what to do: "they ...".
std::string Reason(const IgtlSeen& seen) {
  const std::string size = std::to_string(seen.words[0]);
  switch (seen.fault) {
    case IgtlFault::kNoChecksum:
      return Mark(
          "their checksum is 0, which the sender did not compute; let it compute OpenIGTLink's CRC-64");
    case IgtlFault::kChecksum:
      return Fill(
          Mark(
              "their checksum is wrong (in the last one {1} instead of {2}): bytes change on the way, or the "
              "sender computes another; it has to be OpenIGTLink's CRC-64"),
          {Hexadecimal(seen.words[0]), Hexadecimal(seen.words[1])});
    case IgtlFault::kSize:
      return Fill(Mark("a body of {1} bytes does not fit this kind of message; let the server send what the "
                       "protocol says"),
                  {size});
    case IgtlFault::kManyTools:
      return Fill(
          Mark("they have more than {1} tools ({2} bytes); let the server send fewer tools in one message"),
          {std::to_string(kMostIgtlTools), size});
    case IgtlFault::kExtendedHeader:
      return Fill(Mark("their extended header and metadata are longer than their body of {1} bytes; let the "
                       "server send "
                       "what the protocol says"),
                  {size});
    case IgtlFault::kNoRotation:
      return Mark("they have a place without a rotation; let the server send TRANSFORM");
    case IgtlFault::kZero:
      return Mark("their rotation is all zeros, as trackers send for a tool that they do not see");
    case IgtlFault::kNumbers:
      return Mark("a number is not finite or a place is farther away than 100 m");
    case IgtlFault::kByteOrder:
      return Mark("their numbers have the wrong byte order; OpenIGTLink sends the highest byte first");
    case IgtlFault::kMirror:
      return Mark(
          "the matrix mirrors (its determinant is negative), which no pose does; make the axes right-handed "
          "at the "
          "server");
    case IgtlFault::kSkew:
      return Fill(Mark("the axes of the matrix are {1} degrees off a right angle, which no pose is; let the "
                       "server send a "
                       "rotation and a place only"),
                  {Number(seen.numbers[0])});
    case IgtlFault::kScale:
      return Fill(Mark("the lengths of the axes are {1}, {2} and {3} instead of 1, a scale, which no pose "
                       "has; take it out at "
                       "the server"),
                  {Number(seen.numbers[0]), Number(seen.numbers[1]), Number(seen.numbers[2])});
  }
  return {};
}

}  // namespace

std::vector<std::string> IgtlReader::DescribeRefused() const {
  struct Group {
    std::string reason, titles;
    std::size_t names = 0;
    std::uint64_t refused = 0, came = 0;
  };
  std::vector<Group> groups;
  for (const IgtlSeen& seen : Seen()) {
    // a tool that is out of sight now and then is no fault
    if (seen.refused == 0 || (seen.fault == IgtlFault::kZero && seen.poses > 0)) continue;
    const std::string reason = Reason(seen);
    auto group =
        std::find_if(groups.begin(), groups.end(), [&](const Group& one) { return one.reason == reason; });
    if (group == groups.end()) group = groups.insert(groups.end(), Group{reason, {}, 0, 0, 0});
    if (group->names < kMostNames) group->titles += (group->names > 0 ? ", " : "") + Title(seen);
    if (group->names == kMostNames) group->titles += ", ...";
    ++group->names;
    group->refused += seen.refused;
    group->came += seen.came;
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const Group& a, const Group& b) { return a.refused > b.refused; });
  std::vector<std::string> sentences;
  for (const Group& group : groups)
    sentences.push_back(
        Fill(Mark("{1}: {2} of {3} do not count, because {4}"),
             {group.titles, std::to_string(group.refused), std::to_string(group.came), group.reason}));
  return sentences;
}

std::string IgtlReader::DescribeReceived() const {
  std::string text;
  for (const IgtlSeen& seen : Seen())
    text += (text.empty() ? "" : ", ") + Title(seen) + " (" + std::to_string(seen.came) + ")";
  if (unseen_ > 0) text += ", ... (" + std::to_string(unseen_) + ")";
  return text;
}

std::string IgtlReader::DescribeBadHeader() const {
  if (!is_header_bad_) return {};
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(buffer_[at]); };
  const unsigned version = byte(0) << 8 | byte(1);
  const std::string beginning = host::Printable({buffer_.data(), 16}, 80);
  const std::string_view type(buffer_.data() + 2, 12);
  const bool has_type = type.front() >= 'A' && type.front() <= 'Z';
  if (has_type && byte(1) == 0 && byte(0) >= 1 && byte(0) <= 3)
    return Mark("the header's numbers have the wrong byte order; OpenIGTLink sends the highest byte first");
  if (has_type && byte(0) == 0 && version > 3)
    return Fill(Mark("the messages have version {1} of the header, and 1 to 3 are read; let the server send "
                     "one of these"),
                {std::to_string(version)});
  if (has_type && version >= 1 && version <= 3) {
    std::uint64_t size = 0;
    for (std::size_t i = 42; i < 50; ++i) size = size << 8 | byte(i);
    return Fill(
        Mark("a message announces a body of {1} bytes, which cannot be; the server or the line is at fault"),
        {std::to_string(size)});
  }
  return Fill(Mark("it is no OpenIGTLink: what came begins with \"{1}\"; check the port"), {beginning});
}

}  // namespace trocar::device
