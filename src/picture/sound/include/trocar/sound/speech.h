// SPDX-License-Identifier: Apache-2.0
/// \file speech.h  The instructor's words, spoken by eSpeak NG where it is installed.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trocar::sound {

/// espeak-ng in the folders of PATH; empty where it is not installed (Debian: espeak-ng).
std::string FindSpeechProgram();

/// Samples of a WAVE file of 16 bits and one channel, brought to kSampleRate.
/// \return nothing where the bytes are no such file
std::optional<std::vector<float>> ReadWave(std::span<const unsigned char> bytes);

/// A text as samples. Waits for the program, some tenths of a second.
/// \param program   espeak-ng, or another program with its options --stdin, --stdout and -v
/// \param language  "en", "es", ...
/// \return nothing where the program is missing, fails, or gives no sound
std::optional<std::vector<float>> CalcSpeech(const std::string& program, const std::string& text,
                                             const std::string& language);

/// Makes speech in a thread of its own. What is asked for while another text is being made replaces what waits.
class Speaker {
 public:
  /// \param play  gets the samples, in the speaker's thread
  Speaker(std::string program, std::function<void(std::vector<float>)> play);
  Speaker(const Speaker&) = delete;
  Speaker& operator=(const Speaker&) = delete;
  ~Speaker();
  /// Returns at once.
  void Say(std::string_view text, std::string_view language);

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::sound
