// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "attempt_recording.h"
#include "command.h"
#include "console.h"
#include "judgement_text.h"
#include "trocar/agent/surgeon.h"
#include "trocar/assessment/certificate.h"
#include "trocar/assessment/exam.h"
#include "trocar/assessment/proficiency.h"
#include "trocar/core/safe_file.h"
#include "trocar/record/recording.h"

namespace trocar::cli {
namespace {

using assessment::ExamSettings;

struct SealArguments {
  std::string name, task, level = "normal", thresholds, output;
};

core::Status Seal(const SealArguments& arguments) {
  ExamSettings settings;
  settings.name = arguments.name;
  auto operation = scene::FindOperation(arguments.task, {}, 0);
  if (!operation.ok()) return operation.error();
  if (*operation) {
    settings.operation = arguments.task;
  } else {
    settings.task = arguments.task;
    settings.level = arguments.level;
  }
  if (!arguments.thresholds.empty()) {
    auto proficiency = assessment::FindProficiency(arguments.thresholds);
    if (!proficiency.ok()) return proficiency.error();
    if (proficiency->task != arguments.task || proficiency->level != settings.level) {
      return core::Error{core::ErrorCode::kExamInvalid,
                         "the thresholds \"" + arguments.thresholds + "\" are of " + proficiency->task +
                             (proficiency->level.empty() ? "" : ", level " + proficiency->level) +
                             ", and the exam is of another"};
    }
    settings.passes = std::move(proficiency->thresholds);
  }
  const auto sealed = assessment::SealExam(std::move(settings));
  if (!sealed.ok()) return sealed.error();
  const auto published = assessment::WriteExam(arguments.output, *sealed);
  if (!published.ok()) return published.error();
  std::printf("%s: keep it secret until the exam is over\n%s: publish it before the exam\nCommitment %s\n",
              arguments.output.c_str(), published->c_str(), sealed->commitment.c_str());
  return {};
}

struct RunArguments {
  std::string file, surgeon, record, cache;
  std::uint64_t hands = 1;
  double most_seconds = 3600;
  int threads = 1;
};

core::Status RunExam(const RunArguments& arguments) {
  const auto exam = assessment::ReadExam(arguments.file);
  if (!exam.ok()) return exam.error();
  auto description = assessment::DescribeExam(*exam, arguments.cache);
  if (!description.ok()) return description.error();
  description->player = "exam, " + arguments.surgeon + ", seed " + std::to_string(arguments.hands);
  auto made = record::MakeScene(*description);
  if (!made.ok()) return made.error();
  const auto scene = std::make_shared<const scene::Scene>(std::move(*made));
  auto surgeon = agent::MakeSurgeon(arguments.surgeon, scene, arguments.hands);
  if (!surgeon.ok()) return surgeon.error();
  auto simulation = simulation::Simulation::Make(scene, arguments.threads);
  if (!simulation.ok()) return simulation.error();
  auto recording = AttemptRecording::Start(arguments.record, *description, *simulation);
  if (!recording.ok()) return recording.error();
  ProgressBar bar("exam", arguments.most_seconds);
  while (!(*surgeon)->HasFinished() && simulation->GetSnapshot().time < arguments.most_seconds) {
    const scene::Input input = (*surgeon)->Act(simulation->GetSnapshot());
    simulation->Step(input);
    recording->Add(input, *simulation);
    if (simulation->GetSnapshot().tick % 60 == 0) bar.Show(simulation->GetSnapshot().time);
  }
  bar.Finish();
  if (const auto finished = recording->Finish(*simulation); !finished.ok()) return finished;
  std::printf(
      "%s: %s s of the exam \"%s\"\nCertify it: trocar certificate issue %s %s --examinee PSEUDONYM --key "
      "FILE -o "
      "CERTIFICATE\n",
      arguments.record.c_str(), FormatNumber(simulation->GetSnapshot().time, 4).c_str(), exam->name.c_str(),
      arguments.file.c_str(), arguments.record.c_str());
  return {};
}

void AddSeal(CLI::App& exam, Outcome& outcome) {
  CLI::App* command = exam.add_subcommand(
      "seal", "Draw a secret seed, and write the exam's settings with what is to be published before");
  auto a = std::make_shared<SealArguments>();
  command->add_option("--task", a->task, "Task, or operation on a patient that nobody has seen")
      ->required()
      ->type_name("TASK");
  command->add_option("--level", a->level, "Of a task")->type_name("LEVEL")->capture_default_str();
  command->add_option("--name", a->name, "Name of the exam")->required()->type_name("TEXT");
  command
      ->add_option("--thresholds", a->thresholds,
                   "What passes (trocar levels list), or a file; else completing does")
      ->type_name("LEVELS");
  command->add_option("-o,--output", a->output, "File of the exam; only its owner may read it")
      ->required()
      ->type_name("FILE");
  command->footer("Example: trocar exam seal --task peg_transfer --name \"Finals 2026\" -o finals.json");
  command->callback([a, &outcome] { outcome.status = Seal(*a); });
}

void AddRun(CLI::App& exam, Outcome& outcome) {
  CLI::App* command = exam.add_subcommand("run", "Hold an exam with a scripted surgeon, and record it");
  auto a = std::make_shared<RunArguments>();
  command->add_option("file", a->file, "File of the exam, as trocar exam seal wrote it")
      ->required()
      ->type_name("FILE");
  command->add_option("--surgeon", a->surgeon, "Who is examined (trocar play --list)")
      ->required()
      ->type_name("SURGEON");
  command->add_option("--record", a->record, "Recording to write")->required()->type_name("FILE");
  command->add_option("--seed", a->hands, "Of the hands; the exam's own seed is sealed")
      ->check(CLI::Range(0, 2147483647))
      ->type_name("K")
      ->capture_default_str();
  command->add_option("--seconds", a->most_seconds, "Simulated time after which the surgeon is stopped")
      ->check(CLI::Range(1.0, 3600.0))
      ->type_name("S")
      ->capture_default_str();
  command->add_option("--cache", a->cache, "Folder for the patient; the user's cache folder if not given")
      ->type_name("DIR");
  command->add_option("--threads", a->threads, "Of the solver; the result is the same for any number")
      ->check(CLI::Range(1, 256))
      ->type_name("T")
      ->capture_default_str();
  command->footer("Example: trocar exam run finals.json --surgeon expert --record finals-7.trocar");
  command->callback([a, &outcome] { outcome.status = RunExam(*a); });
}

}  // namespace

void AddExamCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command =
      app.add_subcommand("exam", "Exams whose settings nobody knows before, and nobody changes after");
  command->require_subcommand(1);
  AddSeal(*command, outcome);
  AddRun(*command, outcome);
  CLI::App* check =
      command->add_subcommand("check", "Say whether an exam's settings are those that were published");
  auto file = std::make_shared<std::string>(), published = std::make_shared<std::string>();
  check->add_option("file", *file, "File of the exam")->required()->type_name("FILE");
  check->add_option("published", *published, "What was published before")->required()->type_name("PUBLISHED");
  check->callback([=, &outcome] {
    const auto exam = assessment::ReadExam(*file);
    outcome.status = exam.ok() ? assessment::CheckPublished(*published, *exam) : core::Status(exam.error());
    if (outcome.status.ok())
      std::printf("%s: sealed as published, seed %llu\n", file->c_str(),
                  static_cast<unsigned long long>(exam->seed));
  });
}

namespace {

struct CertificateArguments {
  std::string exam, recording, examinee, key, certificate, output, cache;
  int threads = 1;
};

assessment::ReplaySettings MakeReplaySettings(const CertificateArguments& arguments, ProgressBar& bar) {
  assessment::ReplaySettings settings;
  settings.threads = arguments.threads;
  settings.progress = [&bar](double share) { bar.Show(share); };
  return settings;
}

core::Status Issue(const CertificateArguments& arguments) {
  const auto exam = assessment::ReadExam(arguments.exam);
  if (!exam.ok()) return exam.error();
  ProgressBar bar("replaying", 1.0);
  const auto text =
      assessment::IssueCertificate(*exam, arguments.recording, arguments.examinee, arguments.key,
                                   arguments.cache, MakeReplaySettings(arguments, bar));
  bar.Finish();
  if (!text.ok()) return text.error();
  if (const auto written = core::WriteFile(arguments.output, *text); !written.ok()) return written;
  std::printf("%s: certificate for %s; give it away together with %s\n", arguments.output.c_str(),
              arguments.examinee.c_str(), arguments.recording.c_str());
  return {};
}

core::Status Verify(const CertificateArguments& arguments) {
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
  std::printf("VERIFIED: signature, recording and outcome are as they were issued\n");
  const std::vector<std::vector<std::string>> rows = {
      {"exam",
       exam.name + ": " + (exam.IsOperation() ? exam.operation : exam.task + ", level " + exam.level)},
      {"seed", std::to_string(exam.seed)},
      {"commitment", exam.commitment},
      {"examinee", verified->examinee},
      {"begun", verified->started},
      {"issued", verified->issued},
      {"completed", verified->is_completed ? "yes" : "no"},
      {"passed", verified->is_passed ? "yes" : "no"},
      {"signed with", verified->public_key}};
  std::fputs(FormatTable(rows).c_str(), stdout);
  if (signer.empty())
    std::printf(
        "Whose key that is, only its owner can tell: compare it with the one that the centre publishes "
        "(--key).\n");
  std::fputs(WrapText(std::string(assessment::CertificateStatement()), 100, "").c_str(), stdout);
  return {};
}

}  // namespace

void AddCertificateCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command =
      app.add_subcommand("certificate", "Signed certificates of exams: make keys, issue, verify offline");
  command->require_subcommand(1);
  CLI::App* keygen = command->add_subcommand("keygen", "Make a key to sign with, and one to publish");
  auto name = std::make_shared<std::string>();
  keygen->add_option("-o,--output", *name, "Writes NAME.key, only for its owner, and NAME.pub")
      ->required()
      ->type_name("NAME");
  keygen->callback([=, &outcome] {
    outcome.status = assessment::MakeKeys(*name);
    if (outcome.status.ok())
      std::printf("%s.key: keep it secret, and a copy in a safe place\n%s.pub: publish it\n", name->c_str(),
                  name->c_str());
  });
  auto a = std::make_shared<CertificateArguments>();
  const auto add_common = [a](CLI::App& one) {
    one.add_option("--cache", a->cache, "Folder for the patient; the user's cache folder if not given")
        ->type_name("DIR");
    one.add_option("--threads", a->threads, "Of the solver; the result is the same for any number")
        ->check(CLI::Range(1, 256))
        ->type_name("T")
        ->capture_default_str();
  };
  CLI::App* issue =
      command->add_subcommand("issue", "Replay the recording of an exam, and sign what it came to");
  issue->add_option("exam", a->exam, "File of the exam")->required()->type_name("EXAM");
  issue->add_option("recording", a->recording, "Recording of it")->required()->type_name("RECORDING");
  issue->add_option("--examinee", a->examinee, "Pseudonym of who was examined")
      ->required()
      ->type_name("PSEUDONYM");
  issue->add_option("--key", a->key, "Private key")->required()->type_name("FILE");
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
  verify->callback([a, &outcome] { outcome.status = Verify(*a); });
  command->footer("Example: trocar certificate verify finals-7.json finals-7.trocar --key centre.pub");
}

}  // namespace trocar::cli
