// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/certificate.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <string>

#include "recorded_attempt.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::assessment {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

/// A short exam, played by a scripted surgeon, once for all tests.
class Certificates : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    ExamSettings settings;
    settings.name = "Instruments";
    settings.task = "instrument_navigation";
    settings.level = "normal";
    auto sealed = SealExam(settings);
    ASSERT_TRUE(sealed.ok()) << sealed.error().Text();
    exam_ = new ExamSettings(std::move(*sealed));
    const auto description = DescribeExam(*exam_);
    ASSERT_TRUE(description.ok()) << description.error().Text();
    test::RecordAttempt(Recording(), *description, {});
    ASSERT_TRUE(MakeKeys(Path("centre")).ok());
    auto text = IssueCertificate(*exam_, Recording(), "trainee-7", SigningKey{Path("centre.key"), ""});
    ASSERT_TRUE(text.ok()) << text.error().Text();
    text_ = new std::string(std::move(*text));
    ASSERT_TRUE(host::WriteFile(Path("certificate.json"), *text_).ok());
  }
  static void TearDownTestSuite() {
    delete text_;
    delete exam_;
    delete folder_;
  }
  static fs::path Path(const std::string& name) { return folder_->Path() / name; }
  static fs::path Recording() { return Path("exam.trocar"); }

  static test::TemporaryFolder* folder_;
  static ExamSettings* exam_;
  static std::string* text_;
};
test::TemporaryFolder* Certificates::folder_ = nullptr;
ExamSettings* Certificates::exam_ = nullptr;
std::string* Certificates::text_ = nullptr;

TEST_F(Certificates, SurvivesAndIsVerifiedByReplay) {
  const auto key = ReadPublicKey(Path("centre.pub"));
  ASSERT_TRUE(key.ok());
  const auto verified = VerifyCertificate(Path("certificate.json"), Recording(), *key);
  ASSERT_TRUE(verified.ok()) << verified.error().Text();
  EXPECT_EQ(verified->examinee, "trainee-7");
  EXPECT_TRUE(verified->is_completed);
  EXPECT_TRUE(verified->is_passed);
  EXPECT_EQ(verified->exam.seed, exam_->seed);
  EXPECT_FALSE(verified->metrics.values.empty());
  EXPECT_NE(verified->outcome.find("\"completed\""), std::string::npos) << verified->outcome;
}

/// \param step  from one bit to the next
void ExpectTurnedBitsFound(const std::string& whole, std::size_t step) {
  ASSERT_TRUE(ReadCertificate(whole, "whole").ok()) << "the control";
  std::string text = whole;
  for (std::size_t bit = 0; bit < 8 * text.size(); bit += step) {
    const auto flip = static_cast<char>(1 << (bit % 8));
    text[bit / 8] = static_cast<char>(text[bit / 8] ^ flip);
    const auto read = ReadCertificate(text, "flipped");
    ASSERT_FALSE(read.ok()) << "bit " << bit << " of byte " << bit / 8;
    ASSERT_EQ(read.error().code, ErrorCode::kCertificateInvalid) << "bit " << bit;
    text[bit / 8] = static_cast<char>(text[bit / 8] ^ flip);
  }
}

// The slow test turns every bit.
TEST_F(Certificates, ABitThatIsTurnedInAnyByteIsFound) {
  ExpectTurnedBitsFound(*text_, 7);
}

class CertificatesSlow : public Certificates {};

TEST_F(CertificatesSlow, EverySingleBitThatIsTurnedIsFound) {
  ExpectTurnedBitsFound(*text_, 1);
}

TEST_F(Certificates, EveryLengthThatIsCutIsFound) {
  for (std::size_t length = 0; length < text_->size(); ++length)
    ASSERT_EQ(ReadCertificate(text_->substr(0, length), "cut").error().code, ErrorCode::kCertificateInvalid)
        << length;
  EXPECT_FALSE(ReadCertificate(*text_ + "\n", "longer").ok());
}

TEST_F(Certificates, ABitOfTheRecordingThatIsTurnedIsFoundAnywhere) {
  const auto certificate = ReadCertificate(*text_, "whole");
  ASSERT_TRUE(certificate.ok());
  auto content = host::ReadFile(Recording());
  ASSERT_TRUE(content.ok());
  const auto bytes = [&] { return std::as_bytes(std::span(std::as_const(*content))); };
  ASSERT_TRUE(CheckRecordingBytes(*certificate, bytes()).ok()) << "the control";
  const std::size_t step = std::max<std::size_t>(1, content->size() / 400);
  for (std::size_t byte = 0; byte < content->size(); byte += step) {
    const auto flip = static_cast<char>(1 << (byte % 8));
    (*content)[byte] = static_cast<char>((*content)[byte] ^ flip);
    ASSERT_EQ(CheckRecordingBytes(*certificate, bytes()).error().code, ErrorCode::kCertificateRecording)
        << byte;
    (*content)[byte] = static_cast<char>((*content)[byte] ^ flip);
  }
  content->pop_back();
  EXPECT_EQ(CheckRecordingBytes(*certificate, bytes()).error().code, ErrorCode::kCertificateRecording);
}

TEST_F(Certificates, AnotherSignerIsRefusedWhereOneIsExpected) {
  ASSERT_TRUE(MakeKeys(Path("stranger")).ok());
  const auto forged =
      IssueCertificate(*exam_, Recording(), "trainee-7", SigningKey{Path("stranger.key"), ""});
  ASSERT_TRUE(forged.ok());
  const auto key = ReadPublicKey(Path("centre.pub"));
  EXPECT_EQ(ReadCertificate(*forged, "forged", *key).error().code, ErrorCode::kCertificateSigner);
  EXPECT_TRUE(ReadCertificate(*text_, "own", *key).ok());
}

TEST_F(Certificates, ARecordingOfOtherSettingsIsNotCertified) {
  ExamSettings other = *exam_;
  auto sealed = SealExam(other);
  ASSERT_TRUE(sealed.ok());
  const auto issued = IssueCertificate(*sealed, Recording(), "trainee-7", SigningKey{Path("centre.key"), ""});
  ASSERT_FALSE(issued.ok());
  EXPECT_EQ(issued.error().code, ErrorCode::kCertificateRecording) << issued.error().Text();
}

TEST_F(Certificates, ACutRecordingIsNotCertified) {
  const auto content = host::ReadFile(Recording());
  ASSERT_TRUE(host::WriteFile(Path("cut.trocar"), content->substr(0, content->size() / 2)).ok());
  const auto issued =
      IssueCertificate(*exam_, Path("cut.trocar"), "trainee-7", SigningKey{Path("centre.key"), ""});
  ASSERT_FALSE(issued.ok());
  EXPECT_EQ(issued.error().code, ErrorCode::kCertificateRecording) << issued.error().Text();
}

TEST_F(Certificates, AKeyThatOthersMayReadIsRefused) {
  struct stat status {};
  ASSERT_EQ(::stat(Path("centre.key").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0600u);
  ASSERT_TRUE(MakeKeys(Path("loose")).ok());
  for (const mode_t mode : {0640u, 0604u, 0620u, 0644u}) {
    ASSERT_EQ(::chmod(Path("loose.key").c_str(), mode), 0);
    const auto issued = IssueCertificate(*exam_, Recording(), "trainee-7", SigningKey{Path("loose.key"), ""});
    ASSERT_FALSE(issued.ok());
    EXPECT_EQ(issued.error().code, ErrorCode::kKeyUnsafe);
    EXPECT_NE(issued.error().message.find("chmod 600"), std::string::npos);
  }
}

TEST_F(Certificates, KeysAreNotReplacedAndNoOtherFileIsTakenForOne) {
  EXPECT_EQ(MakeKeys(Path("centre")).error().code, ErrorCode::kFileUnwritable);
  EXPECT_EQ(ReadPublicKey(Path("centre.key")).error().code, ErrorCode::kKeyInvalid);
  EXPECT_EQ(ReadPublicKey(Recording()).error().code, ErrorCode::kFileTooLarge);
  ASSERT_TRUE(host::WriteFile(Path("no.key"), "trocar-private-key-1 abc\n").ok());
  ::chmod(Path("no.key").c_str(), 0600);
  EXPECT_EQ(IssueCertificate(*exam_, Recording(), "t", SigningKey{Path("no.key"), ""}).error().code,
            ErrorCode::kKeyInvalid);
}

TEST_F(Certificates, AnEncryptedKeySignsWithItsPassphraseAlone) {
  ASSERT_TRUE(MakeKeys(Path("locked"), "seven green herons").ok());
  struct stat status {};
  ASSERT_EQ(::stat(Path("locked.key").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0600u);
  EXPECT_EQ(IsKeyEncrypted(Path("locked.key")).value(), true);
  EXPECT_EQ(IsKeyEncrypted(Path("centre.key")).value(), false);
  for (const char* wrong : {"", "seven green heron", "Seven green herons", "seven green herons "}) {
    const auto issued = IssueCertificate(*exam_, Recording(), "t", SigningKey{Path("locked.key"), wrong});
    ASSERT_FALSE(issued.ok()) << wrong;
    EXPECT_EQ(issued.error().code, ErrorCode::kKeyLocked) << issued.error().Text();
  }
  const auto issued = IssueCertificate(*exam_, Recording(), "trainee-7",
                                       SigningKey{Path("locked.key"), "seven green herons"});
  ASSERT_TRUE(issued.ok()) << issued.error().Text();
  const auto signer = ReadPublicKey(Path("locked.pub"));
  ASSERT_TRUE(signer.ok());
  EXPECT_TRUE(ReadCertificate(*issued, "own", *signer).ok());
}

TEST_F(Certificates, TheSamePassphraseEncryptsEachKeyAnew) {
  ASSERT_TRUE(MakeKeys(Path("first"), "seven green herons").ok());
  ASSERT_TRUE(MakeKeys(Path("second"), "seven green herons").ok());
  const auto first = host::ReadFile(Path("first.key")), second = host::ReadFile(Path("second.key"));
  const auto salt = [](const std::string& text) { return text.substr(text.find(' ') + 1, 32); };
  EXPECT_NE(salt(*first), salt(*second));
}

TEST_F(Certificates, ASpoiledEncryptedKeyIsNoWrongPassphrase) {
  ASSERT_TRUE(MakeKeys(Path("spoiled"), "seven green herons").ok());
  const auto whole = host::ReadFile(Path("spoiled.key"));
  ASSERT_TRUE(whole.ok());
  const auto read = [&](const std::string& text) {
    EXPECT_TRUE(host::WriteFile(Path("spoiled.key"), text).ok());
    ::chmod(Path("spoiled.key").c_str(), 0600);
    return IsKeyEncrypted(Path("spoiled.key"));
  };
  ASSERT_TRUE(read(*whole).ok()) << "the control";
  for (std::size_t length = 0; length < whole->size(); ++length)
    ASSERT_EQ(read(whole->substr(0, length)).error().code, ErrorCode::kKeyInvalid) << length;
  for (std::size_t byte = 0; byte < whole->size(); ++byte) {
    std::string text = *whole;
    text[byte] = text[byte] == '0' ? '1' : '0';
    ASSERT_EQ(read(text).error().code, ErrorCode::kKeyInvalid) << byte;
  }
  EXPECT_FALSE(read(*whole + "\n").ok());
}

TEST_F(Certificates, AShortPassphraseMakesNoKey) {
  EXPECT_EQ(MakeKeys(Path("short"), "heron").error().code, ErrorCode::kUsage);
  EXPECT_FALSE(fs::exists(Path("short.key")) || fs::exists(Path("short.pub")));
}

TEST_F(Certificates, GivesUpWhereItIsAsked) {
  // while it is verified, and while it is measured
  for (const double most : {0.2, 0.7}) {
    ReplaySettings settings;
    double last = 0;
    settings.progress = [&last, most](double share) { return (last = share) < most; };
    const auto issued =
        IssueCertificate(*exam_, Recording(), "t", SigningKey{Path("centre.key"), ""}, {}, settings);
    ASSERT_FALSE(issued.ok());
    EXPECT_EQ(issued.error().code, ErrorCode::kCancelled);
    EXPECT_LT(last, most + 0.1) << "at once";
  }
}

TEST_F(Certificates, SaysThatItIsNoAssessmentOfCompetence) {
  EXPECT_NE(text_->find("not certified assessment"), std::string::npos);
  // the fixed words are those of the page
  const auto page = host::ReadFile(fs::path(TROCAR_SOURCE_DIR) / "docs/intended-use.md");
  ASSERT_TRUE(page.ok());
  EXPECT_NE(page->find("**Training feedback, not certified assessment.**"), std::string::npos);
  EXPECT_NE(page->find("To certify, license or credential anybody"), std::string::npos);
}

TEST(Exam, SealIsBrokenByAnyOtherSetting) {
  test::TemporaryFolder folder;
  ExamSettings settings;
  settings.name = "Wire";
  settings.task = "wire_run";
  settings.level = "easy";
  settings.passes = {{{"time", "", ""}, Better::kLower, 40.25, Purpose::kTime, false, ""}};
  const auto sealed = SealExam(settings);
  ASSERT_TRUE(sealed.ok()) << sealed.error().Text();
  const auto path = folder.Path() / "exam.json";
  const auto published = WriteExam(path, *sealed);
  ASSERT_TRUE(published.ok()) << published.error().Text();
  const auto read = ReadExam(path);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->seed, sealed->seed);
  EXPECT_EQ(read->passes[0].value, 40.25);
  EXPECT_TRUE(CheckPublished(*published, *read).ok());
  // the published half keeps the secret
  const auto text = host::ReadFile(*published);
  EXPECT_EQ(text->find("\"seed\""), std::string::npos);
  EXPECT_EQ(text->find(sealed->nonce), std::string::npos);
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0600u);
  // easier afterwards
  auto whole = host::ReadFile(path);
  whole->replace(whole->find("40.25"), 5, "90.25");
  ASSERT_TRUE(host::WriteFile(folder.Path() / "easier.json", *whole).ok());
  EXPECT_EQ(ReadExam(folder.Path() / "easier.json").error().code, ErrorCode::kExamSealBroken);
  // another exam than the one that was announced
  const auto other = SealExam(settings);
  EXPECT_EQ(CheckPublished(*published, *other).error().code, ErrorCode::kExamSealBroken);
  EXPECT_NE(other->seed, sealed->seed);
  EXPECT_FALSE(WriteExam(path, *other).ok()) << "a seal is not replaced";
}

// The seal is of what was read: a word that is taken for its default would not break it.
TEST(Exam, AWordThatIsNotKnownIsNoDefault) {
  test::TemporaryFolder folder;
  ExamSettings settings;
  settings.name = "Wire";
  settings.task = "wire_run";
  settings.level = "easy";
  settings.passes = {{{"time", "", ""}, Better::kLower, 40.25, Purpose::kSafety, false, ""}};
  const auto sealed = SealExam(settings);
  ASSERT_TRUE(sealed.ok()) << sealed.error().Text();
  const auto path = folder.Path() / "exam.json", odd = folder.Path() / "odd.json";
  ASSERT_TRUE(WriteExam(path, *sealed).ok());
  const auto good = host::ReadFile(path);
  ASSERT_TRUE(good.ok() && ReadExam(path).ok());
  for (const char* field : {"better", "purpose", "undefined", "hand"}) {
    for (const char* word : {"bogus", "LOWER", "lower ", "1"}) {
      std::string text = *good;
      const std::size_t at = text.find("\"" + std::string(field) + "\"");
      ASSERT_NE(at, std::string::npos) << field;
      const std::size_t begin = text.find('"', text.find(':', at)) + 1, end = text.find('"', begin);
      text.replace(begin, end - begin, word);
      ASSERT_TRUE(host::WriteFile(odd, text).ok());
      const auto read = ReadExam(odd);
      ASSERT_FALSE(read.ok()) << field << ": " << word;
      EXPECT_EQ(read.error().code, ErrorCode::kExamInvalid) << field << ": " << word;
      EXPECT_NE(read.error().message.find(std::string(field) + " is one of"), std::string::npos)
          << read.error().message;
    }
  }
}

TEST(Exam, NamesWhatThereIs) {
  ExamSettings settings;
  settings.task = "juggling";
  settings.level = "normal";
  EXPECT_EQ(SealExam(settings).error().code, ErrorCode::kExamInvalid);
  settings.task = "peg_transfer";
  settings.level = "easy";
  EXPECT_EQ(SealExam(settings).error().code, ErrorCode::kExamInvalid) << "it has one level";
  settings.operation = "cholecystectomy";
  EXPECT_EQ(SealExam(settings).error().code, ErrorCode::kExamInvalid) << "both";
}

}  // namespace
}  // namespace trocar::assessment
