// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "judgement_text.h"
#include "passphrase.h"
#include "pseudonym_option.h"
#include "trocar/assessment/certificate.h"
#include "trocar/assessment/exam.h"
#include "trocar/host/safe_file.h"

namespace trocar::cli {

using host::ProgressBar;
using host::Say;

namespace {

struct CertificateArguments {
  std::string exam, recording, examinee, key, certificate, output, cache;
  int threads = 1;
};

assessment::ReplaySettings MakeReplaySettings(const CertificateArguments& arguments, ProgressBar& bar) {
  assessment::ReplaySettings settings;
  settings.threads = arguments.threads;
  settings.progress = [&bar](double share) { return bar.Show(share), true; };
  return settings;
}

base::Status MakeKeys(const std::string& name) {
  const auto passphrase = FindNewPassphrase(name + ".key");
  if (!passphrase.ok()) return passphrase.error();
  if (const auto made = assessment::MakeKeys(name, *passphrase); !made.ok()) return made;
  Say("{1}.key: keep it secret, and a copy in a safe place\n{1}.pub: publish it\n", name);
  if (passphrase->empty()) {
    const std::string warning = host::TranslateWith(
        "warning: {1}.key is not encrypted; whoever reads it can sign in your name. For an encrypted "
        "one delete both files, set TROCAR_KEY_PASSPHRASE or begin at a terminal, and make them again",
        {name});
    host::PrintErrorLine(warning);
  }
  return {};
}

base::Status Issue(const CertificateArguments& arguments) {
  const auto exam = assessment::ReadExam(arguments.exam);
  if (!exam.ok()) return exam.error();
  auto passphrase = FindPassphrase(arguments.key);
  if (!passphrase.ok()) return passphrase.error();
  const assessment::SigningKey key{arguments.key, std::move(*passphrase)};
  ProgressBar bar("replaying", 1.0);
  const auto text = assessment::IssueCertificate(*exam, arguments.recording, arguments.examinee, key,
                                                 arguments.cache, MakeReplaySettings(arguments, bar));
  bar.Finish();
  if (!text.ok()) return text.error();
  if (const auto written = host::WriteFile(arguments.output, *text); !written.ok()) return written;
  Say("{1}: certificate for {2}; give it away together with {3}\n", arguments.output, arguments.examinee,
      arguments.recording);
  return {};
}

base::Status VerifyCertificate(const CertificateArguments& arguments) {
  std::string signer;
  if (!arguments.key.empty()) {
    auto key = assessment::ReadPublicKey(arguments.key);
    if (!key.ok()) return key.error();
    signer = std::move(*key);
  }
  ProgressBar bar("replaying", 1.0);
  const auto verified = assessment::VerifyCertificate(arguments.certificate, arguments.recording, signer,
                                                      arguments.cache, MakeReplaySettings(arguments, bar));
  bar.Finish();
  if (!verified.ok()) return verified.error();
  const auto& exam = verified->exam;
  Say("VERIFIED: signature, recording and outcome are as they were issued\n");
  const auto yes = [](bool is_so) { return host::Translate(is_so ? "yes" : "no"); };
  host::PrintLines(host::FormatFields(
      {{"exam", exam.name + ": " +
                    (exam.IsOperation() ? exam.operation
                                        : host::TranslateWith("{1}, level {2}", {exam.task, exam.level}))},
       {"seed", std::to_string(exam.seed)},
       {"commitment", exam.commitment},
       {"examinee", verified->examinee},
       {"begun", verified->started},
       {"issued", verified->issued},
       {"completed", yes(verified->is_completed)},
       {"passed", yes(verified->is_passed)},
       {"signed with", verified->public_key}}));
  if (signer.empty())
    Say("Whose key that is, only its owner can tell: compare it with the one that the centre publishes "
        "(--key).\n");
  host::PrintLines(host::WrapText(host::Translate(assessment::CertificateStatement()), 100, ""));
  return {};
}

}  // namespace

void AddCertificateCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "certificate");
  command->require_subcommand(1);
  CLI::App* keygen = command->add_subcommand("keygen", "Make a key to sign with, and one to publish");
  auto name = std::make_shared<std::string>();
  keygen->add_option("-o,--output", *name, "Writes NAME.key, only for its owner, and NAME.pub")
      ->required()
      ->type_name("NAME");
  keygen->footer(
      "NAME.key is encrypted with a passphrase: that of TROCAR_KEY_PASSPHRASE, or one that is asked for at "
      "the "
      "terminal. Without one it is stored as it is, with a warning.");
  keygen->callback([=, &outcome] { outcome.status = MakeKeys(*name); });
  auto a = std::make_shared<CertificateArguments>();
  const auto add_common = [a](CLI::App& one) {
    AddCacheOption(one, a->cache);
    AddThreadsOption(one, a->threads);
  };
  CLI::App* issue =
      command->add_subcommand("issue", "Replay the recording of an exam, and sign what it came to");
  issue->add_option("exam", a->exam, "File of the exam")->required()->type_name("EXAM");
  issue->add_option("recording", a->recording, "Recording of it")->required()->type_name("RECORDING");
  AddPseudonymOption(*issue, "--examinee", a->examinee, "Pseudonym of who was examined")->required();
  issue
      ->add_option("--key", a->key,
                   "Private key; its passphrase is taken from TROCAR_KEY_PASSPHRASE or asked for")
      ->required()
      ->type_name("FILE");
  issue->add_option("-o,--output", a->output, "Certificate to write")->required()->type_name("FILE");
  add_common(*issue);
  issue->callback([a, &outcome] { outcome.status = Issue(*a); });
  CLI::App* verify = command->add_subcommand(
      "verify",
      "Check signature and recording of a certificate, and compute the recording again; needs no network");
  verify->add_option("certificate", a->certificate, "Certificate")->required()->type_name("CERTIFICATE");
  verify->add_option("recording", a->recording, "Recording that came with it")
      ->required()
      ->type_name("RECORDING");
  verify->add_option("--key", a->key, "Public key that must have signed")->type_name("FILE");
  add_common(*verify);
  verify->callback([a, &outcome] { outcome.status = VerifyCertificate(*a); });
  command->footer("Example: trocar certificate verify finals-7.json finals-7.trocar --key centre.pub");
}

}  // namespace trocar::cli
