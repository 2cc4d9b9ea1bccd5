// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/certificate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "exam_json.h"
#include "private_key.h"
#include "signing.h"
#include "trocar/base/to_integer.h"
#include "trocar/host/json.h"
#include "trocar/host/safe_file.h"
#include "trocar/record/replay.h"

namespace trocar::assessment {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;
using host::JsonView;
using nlohmann::json;

constexpr const char* kFormat = "trocar-certificate";
constexpr std::size_t kLargestRecording = std::size_t{4} << 30;  // [bytes]
/// Before its signature is looked at, anybody may have written it.
constexpr host::JsonLimits kLimits{4u << 20, 16, 100'000, 1000, 1u << 20};
constexpr host::NumberRange kBytes{1, 4294967296.0};
constexpr double kSameMetric = 1e-9;  // of a metric, or of 1 where it is smaller [-]
/// Before what is signed, so that a signature for something else is none for a certificate.
constexpr std::string_view kDomain = "trocar-certificate-1\n";

json MetricsJson(const training::AttemptMetrics& metrics) {
  json list = json::array();
  for (const training::MetricValue& value : metrics.values) {
    list.push_back({{"metric", value.metric},
                    {"hand", value.hand},
                    {"phase", value.phase},
                    {"tool", value.tool},
                    {"value", FormatExact(value.value)}});
  }
  return list;
}

/// Without the signature.
json CertificateJson(const Certificate& c) {
  return {{"format", kFormat},
          {"version", 1},
          {"statement", CertificateStatement()},
          {"exam", ExamJson(c.exam, ExamPart::kAll)},
          {"examinee", c.examinee},
          {"issued", c.issued},
          {"started", c.started},
          {"program", c.program},
          {"compiler", c.compiler},
          {"recording", {{"bytes", c.recording_bytes}, {"blake2b_256", c.recording_hash}}},
          {"outcome", c.outcome},
          {"metrics", MetricsJson(c.metrics)},
          {"completed", c.is_completed},
          {"passed", c.is_passed},
          {"public_key", c.public_key}};
}

std::string SignedText(const json& without_signature) {
  return std::string(kDomain) + DumpCanonical(without_signature);
}

Certificate ReadFields(const JsonView& root) {
  Certificate c;
  c.exam = ReadExamFields(root.Object("exam"), ExamPart::kAll);
  c.examinee = root.Text("examinee");
  c.issued = root.Text("issued");
  c.started = root.Text("started");
  c.program = root.Text("program");
  c.compiler = root.Text("compiler");
  const JsonView recording = root.Object("recording");
  c.recording_bytes = base::TruncateTo<std::uint64_t>(recording.Number("bytes", kBytes));
  c.recording_hash = recording.Text("blake2b_256");
  c.outcome = root.Text("outcome");
  for (const JsonView& view : root.Array("metrics")) {
    training::MetricValue value;
    value.metric = view.Text("metric");
    value.hand = view.Text("hand");
    value.phase = view.Text("phase");
    value.tool = view.Text("tool");
    const auto number = ParseExact(view.Text("value"));
    if (!number) view.Complain("value is no number");
    value.value = number.value_or(0);
    c.metrics.values.push_back(std::move(value));
  }
  c.is_completed = root.BooleanOr("completed", false);
  c.is_passed = root.BooleanOr("passed", false);
  c.public_key = root.Text("public_key");
  return c;
}

Error Changed(const std::string& source, const std::string& why) {
  return {ErrorCode::kCertificateInvalid,
          source + ": " + why + "; do not trust it, and ask whoever issued it for the file as it was"};
}

/// The same metrics, within what the mathematical libraries of two compilers may differ by.
bool AreSame(const training::AttemptMetrics& a, const training::AttemptMetrics& b) {
  return std::equal(a.values.begin(), a.values.end(), b.values.begin(), b.values.end(),
                    [](const training::MetricValue& one, const training::MetricValue& other) {
                      return one.metric == other.metric && one.hand == other.hand &&
                             one.phase == other.phase && one.tool == other.tool &&
                             std::fabs(one.value - other.value) <=
                                 kSameMetric * std::max(1.0, std::fabs(one.value));
                    });
}

bool PassesAll(const ExamSettings& exam, const AttemptResult& result) {
  Proficiency proficiency;
  proficiency.thresholds = exam.passes;
  return Judge(proficiency, result).is_passed;
}

/// Whether a recording says that it is of the exam; where its patient lay is not compared: that is another folder here.
bool IsOfExam(const record::Description& recorded, const record::Description& exam) {
  return recorded.kind == exam.kind && recorded.name == exam.name && recorded.level == exam.level &&
         recorded.seed == exam.seed && recorded.patient.empty() == exam.patient.empty() &&
         recorded.first_tick == 0;
}

struct Replayed {
  Attempt attempt;
  std::string outcome;
  record::Description description;
};

/// Computes a recording again, with the exam's patient as it is made here.
base::Result<Replayed> ReplayExam(const ExamSettings& exam, std::span<const std::byte> bytes,
                                  const fs::path& path, const fs::path& cache,
                                  const ReplaySettings& settings) {
  const auto read = [&]() -> base::Result<record::Recording> {
    auto recording = record::ReadRecording(bytes, path.string());
    if (!recording.ok()) return recording.error();
    if (!recording->damage.empty() || !recording->ending) {
      return Error{ErrorCode::kCertificateRecording,
                   path.string() + " is " + (recording->damage.empty() ? "not finished" : "damaged") +
                       "; an exam counts only with its whole recording, so it has to be repeated"};
    }
    return recording;
  };
  auto recording = read();
  if (!recording.ok()) return recording.error();
  auto description = DescribeExam(exam, cache);
  if (!description.ok()) return description.error();
  if (!IsOfExam(recording->description, *description)) {
    return Error{ErrorCode::kCertificateRecording,
                 path.string() + " is of \"" + recording->description.name +
                     "\" with other settings than the exam's; take the recording that trocar exam run wrote"};
  }
  recording->description.patient = description->patient;
  Replayed replayed;
  replayed.description = recording->description;
  auto replay = record::Replay::Open(std::move(*recording), settings.threads);
  if (!replay.ok()) return replay.error();
  const auto half = [&](double share) { return !settings.progress || settings.progress(0.5 * share); };
  const auto verified = replay->Verify(half);
  if (!verified.ok()) return verified.error();
  if (!verified->IsVerified()) {
    return Error{ErrorCode::kCertificateOutcome,
                 path.string() +
                     (verified->divergence ? ": computed again, its states are not those that it holds"
                                           : ": computed again, it comes to another outcome than it says") +
                     "; it was edited, or is of another version (" + replayed.description.program + ", " +
                     replayed.description.compiler + ")"};
  }
  replayed.outcome = verified->outcome;
  auto again = read();
  if (!again.ok()) return again.error();
  again->description.patient = description->patient;
  ReplaySettings second = settings;
  second.progress = [&](double share) { return !settings.progress || settings.progress(0.5 + 0.5 * share); };
  auto attempt = MakeAttempt(std::move(*again), second);
  if (!attempt.ok()) return attempt.error();
  replayed.attempt = std::move(*attempt);
  return replayed;
}

}  // namespace

std::string_view CertificateStatement() noexcept {
  return "Training feedback, not certified assessment: says what this recording came to under these "
         "settings, and nothing of "
         "anybody's clinical competence.";
}

base::Result<std::string> IssueCertificate(const ExamSettings& exam, const fs::path& recording,
                                           const std::string& examinee, const SigningKey& key,
                                           const fs::path& cache, const ReplaySettings& settings) {
  if (examinee.empty()) return Error{ErrorCode::kUsage, "a certificate needs the examinee's pseudonym"};
  auto seed = ReadPrivateKey(key);
  if (!seed.ok()) return seed.error();
  const auto content = host::ReadFile(recording, kLargestRecording);
  if (!content.ok()) return content.error();
  const auto bytes = std::as_bytes(std::span(*content));
  const auto replayed = ReplayExam(exam, bytes, recording, cache, settings);
  if (!replayed.ok()) return replayed.error();
  Certificate c;
  c.exam = exam;
  c.examinee = examinee;
  c.issued = NowText();
  c.started = replayed->description.started;
  c.program = replayed->description.program;
  c.compiler = replayed->description.compiler;
  c.recording_bytes = bytes.size();
  c.recording_hash = HashBytes(bytes);
  c.outcome = replayed->outcome;
  c.metrics = replayed->attempt.result.metrics;
  c.is_completed = replayed->attempt.result.is_completed;
  c.is_passed = PassesAll(exam, replayed->attempt.result);
  c.public_key = FormatHex(MakePublicKey(*seed));
  json value = CertificateJson(c);
  const Signature signature = Sign(*seed, SignedText(value));
  Wipe(*seed);
  value["signature"] = FormatHex(signature);
  return DumpCanonical(value);
}

base::Result<Certificate> ReadCertificate(std::string_view text, const std::string& source,
                                          const std::string& signer) {
  auto parsed = host::ParseJson<json>(text, source, kLimits);
  if (!parsed.ok() || !parsed->is_object())
    return Changed(source, "this is no certificate, or it was cut or changed");
  json& value = *parsed;
  // the one way of writing it: other spaces, orders or escapes would be other bytes that say the same
  if (DumpCanonical(value) != text) return Changed(source, "the bytes are not those that were issued");
  const auto found = value.find("signature");
  Signature signature{};
  PublicKey key{};
  if (found == value.end() || !found->is_string() || !ParseHex(found->get<std::string>(), signature) ||
      !value.contains("public_key") || !value["public_key"].is_string() ||
      !ParseHex(value["public_key"].get<std::string>(), key))
    return Changed(source, "it has no signature");
  value.erase("signature");
  if (!IsSignedBy(key, signature, SignedText(value)))
    return Changed(source, "the signature does not fit: something in it was changed");
  const auto document = host::JsonDocument::Parse(text, source, kLimits);
  if (!document.ok()) return Changed(source, document.error().message);
  Certificate certificate = ReadFields(document->Root());
  // what is signed and is no certificate of this format comes from a program that this one does not know
  if (!document->Check().ok() || CertificateJson(certificate) != value) {
    return Changed(
        source,
        "it is signed, but not a certificate that this version reads (" +
            (document->Check().ok() ? std::string("other fields") : document->Check().error().message) + ")");
  }
  if (!signer.empty() && signer != certificate.public_key) {
    return Error{ErrorCode::kCertificateSigner, source + " is signed with the key " + certificate.public_key +
                                                    ", and " + signer +
                                                    " was expected; ask the centre for its public key, and "
                                                    "trust no key that comes with the certificate"};
  }
  if (CalcCommitment(certificate.exam) != certificate.exam.commitment) {
    return Error{ErrorCode::kExamSealBroken,
                 source + ": the exam's settings are not those that were sealed; the exam does not count"};
  }
  return certificate;
}

base::Status CheckRecordingBytes(const Certificate& certificate, std::span<const std::byte> bytes) {
  if (bytes.size() == certificate.recording_bytes && HashBytes(bytes) == certificate.recording_hash)
    return {};
  return Error{
      ErrorCode::kCertificateRecording,
      "the recording is not, to the byte, the one that was certified; take the file that was kept with the "
      "certificate, and do not repair or convert it"};
}

base::Result<Certificate> VerifyCertificate(const fs::path& path, const fs::path& recording,
                                            const std::string& signer, const fs::path& cache,
                                            const ReplaySettings& settings) {
  const auto text = host::ReadFile(path, kLimits.bytes);
  if (!text.ok()) return text.error();
  auto certificate = ReadCertificate(*text, path.string(), signer);
  if (!certificate.ok()) return certificate.error();
  const auto content = host::ReadFile(recording, kLargestRecording);
  if (!content.ok()) return content.error();
  const auto bytes = std::as_bytes(std::span(*content));
  if (const auto status = CheckRecordingBytes(*certificate, bytes); !status.ok()) return status.error();
  const auto replayed = ReplayExam(certificate->exam, bytes, recording, cache, settings);
  if (!replayed.ok()) return replayed.error();
  const AttemptResult& result = replayed->attempt.result;
  const bool is_same = replayed->outcome == certificate->outcome &&
                       result.is_completed == certificate->is_completed &&
                       AreSame(result.metrics, certificate->metrics) &&
                       PassesAll(certificate->exam, result) == certificate->is_passed;
  if (is_same) return certificate;
  return Error{
      ErrorCode::kCertificateOutcome,
      path.string() +
          ": the recording, computed again, does not come to what is certified; verify with the version that "
          "issued it (recorded by " +
          certificate->program + "), and do not trust it if that fails, too"};
}

}  // namespace trocar::assessment
