// SPDX-License-Identifier: Apache-2.0
/// \file certificate.h  A signed statement of what an exam came to, down to the bytes of its recording: anybody can check it offline, by
/// signature, by hash, and by computing the recording again. docs/exams.md describes the file.
///
/// A certificate says that this recording was played under these settings, and with what result; not that somebody is competent:
/// docs/intended-use.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "trocar/assessment/exam.h"
#include "trocar/assessment/judge_recording.h"
#include "trocar/assessment/signing_key.h"
#include "trocar/base/result.h"
#include "trocar/training/metric_value.h"

namespace trocar::assessment {

/// Signed content of a certificate.
struct Certificate {
  ExamSettings exam;              ///< with seed and nonce: the exam is over
  std::string examinee;           ///< pseudonym
  std::string issued, started;    ///< wall clock
  std::string program, compiler;  ///< that recorded
  std::uint64_t recording_bytes = 0;
  std::string recording_hash;  ///< BLAKE2b-256 of the file, 64 hexadecimal digits
  std::string outcome;         ///< record::CalcOutcome
  training::AttemptMetrics metrics;
  bool is_completed = false;
  bool is_passed = false;  ///< completed, and every threshold of the exam met
  std::string public_key;  ///< of who signed, 64 hexadecimal digits
};

/// The sentence that stands in every certificate.
std::string_view CertificateStatement() noexcept;

/// Computes the recording again, twice: for outcome and hashes, and for the metrics.
/// \param examinee  pseudonym, not empty
/// \return the text of the certificate; kKeyInvalid, kKeyUnsafe, kKeyLocked; kCertificateRecording where the recording is not of this exam, not
/// finished or damaged; kCertificateOutcome where it does not replay
base::Result<std::string> IssueCertificate(const ExamSettings& exam, const std::filesystem::path& recording,
                                           const std::string& examinee, const SigningKey& key,
                                           const std::filesystem::path& cache = {},
                                           const ReplaySettings& settings = {});

/// Reads a certificate and checks what needs no recording: that not one bit is another, signature and commitment.
/// \param signer  public key that must have signed, or empty: whoever did
/// \return kCertificateInvalid, kCertificateSigner or kExamSealBroken
base::Result<Certificate> ReadCertificate(std::string_view text, const std::string& source,
                                          const std::string& signer = {});

/// \param bytes  of the recording's file
/// \return kCertificateRecording where they are others
base::Status CheckRecordingBytes(const Certificate& certificate, std::span<const std::byte> bytes);

/// All of it: ReadCertificate, CheckRecordingBytes, and computing the recording again.
/// \return what was certified; the errors of those two; kCertificateRecording where the recording is of another exam;
/// kCertificateOutcome where it comes to something else; kRecordingInvalid where this program cannot replay it
base::Result<Certificate> VerifyCertificate(const std::filesystem::path& certificate,
                                            const std::filesystem::path& recording,
                                            const std::string& signer = {},
                                            const std::filesystem::path& cache = {},
                                            const ReplaySettings& settings = {});

}  // namespace trocar::assessment
