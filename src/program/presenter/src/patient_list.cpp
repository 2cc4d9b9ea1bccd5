// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/patient_list.h"

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include "trocar/base/state_hash.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/log.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"
#include "trocar/host/user_folder.h"
#include "trocar/patient/patient.h"
#include "trocar/render/figure_picture.h"
#include "trocar/scene/scene.h"
#include "trocar/view/patient_figure.h"

namespace trocar::presenter {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBuiltIn = "assets/patients/visible-human-male/patient";
constexpr std::string_view kGenerated = "seed-";
/// Changes where a patient's picture would look other than one in the cache.
constexpr const char* kPictureVersion = "2 ";
constexpr int kWidth = 200, kHeight = 150;  // of a picture [pixels]
constexpr double kLiverOpacity = 0.35;      // the ducts lie behind it

base::Status Draw(const patient::Patient& patient, const fs::path& path) {
  const auto data = host::FindDataFolder();
  if (!data.ok()) return data.error();
  const auto colours = view::ReadPatientColours(*data / view::kPatientColoursFile);
  if (!colours.ok()) return colours.error();
  view::PatientFigureOptions options;
  options.colours = *colours;
  options.has_regions = options.has_landmarks = false;
  options.liver_opacity = kLiverOpacity;
  const view::PatientFigure figure = view::MakePatientFigure(patient, options);
  const render::OrbitCamera camera =
      render::LookFrom(render::Viewpoint::kUmbilicus, render::CalcFigureBox(figure.surfaces),
                       static_cast<double>(kWidth) / kHeight);
  render::FigureOptions look;
  look.has_axes = false;  // letters of directions are for the editor
  const auto pictures =
      render::DrawPictures(figure.surfaces, figure.marks, {&camera, 1}, look, kWidth, kHeight);
  if (!pictures.ok()) return pictures.error();
  std::error_code ignored;
  ignored = host::MakeFolders(path.parent_path());
  return render::WritePng(path, pictures->front());
}

/// The picture in the cache, drawn where it is not there; nothing where it cannot be.
fs::path FindPicture(const fs::path& folder, const patient::Patient& patient) {
  const auto text = host::ReadFile(folder / "patient.json");
  if (!text.ok()) return {};
  base::StateHash hash;
  base::AddStateTo(hash, kPictureVersion + fs::absolute(folder).string() + *text);
  const fs::path path =
      host::FindCacheFolder() / "patient-pictures" / (base::HashText(hash.Value()) + ".png");
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) return path;
  if (const base::Status drawn = Draw(patient, path); !drawn.ok()) {
    host::Log(host::LogLevel::kWarning, "no picture of " + folder.string() + ": " + drawn.error().Text());
    return {};
  }
  return path;
}

/// "gallbladder 78 mm, cystic duct 24 mm; moynihan hump, adhesions": what a surgeon asks for first.
std::string DescribeFindings(const patient::Patient& patient) {
  constexpr std::pair<const char*, const char*> kSizes[] = {{"gallbladder_length", "gallbladder"},
                                                            {"cystic_duct_length", "cystic duct"}};
  constexpr const char* kVariations[] = {
      "double_cystic_artery", "moynihan_hump", "subvesical_duct", "phrygian_cap", "hydrops",
      "acute_cholecystitis",  "scleroatrophy", "steatosis",       "cirrhosis",    "adhesions"};
  std::string sizes, variations;
  for (const auto& [name, shown] : kSizes) {
    const patient::Parameter* parameter = patient.FindParameter(name);
    const double* value = parameter == nullptr ? nullptr : std::get_if<double>(&parameter->value);
    if (value == nullptr) continue;
    sizes += (sizes.empty() ? "" : ", ") + host::Translate(shown) + " " +
             std::to_string(std::lround(*value)) + " " + parameter->unit;
  }
  for (const std::string name : kVariations) {
    const patient::Parameter* parameter = patient.FindParameter(name);
    if (parameter == nullptr) continue;
    const auto* word = std::get_if<std::string>(&parameter->value);
    const bool is_there = word != nullptr ? *word == "yes" : std::get<double>(parameter->value) > 0;
    if (!is_there) continue;
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    variations += (variations.empty() ? "" : ", ") + host::Translate(words);
  }
  return sizes + (sizes.empty() || variations.empty() ? "" : "; ") + variations;
}

PatientEntry DescribePatient(const fs::path& folder) {
  PatientEntry entry;
  entry.folder = folder;
  entry.name = ShortPatientName(folder);
  const auto patient = files::ReadPatient(folder);
  if (!patient.ok()) {
    entry.problem = patient.error();
    return entry;
  }
  entry.about = DescribeFindings(*patient);
  if (patient->tubes.empty())
    entry.problem = base::Error{
        base::ErrorCode::kPatientInvalid,
        folder.string() + ": the patient has no ducts; place a template with trocar anatomy edit"};
  entry.picture = FindPicture(folder, *patient);
  return entry;
}

}  // namespace

fs::path FindPatientsFolder() {
  return host::FindUserDataFolder() / "patients";
}

std::vector<PatientEntry> ListPatients(const fs::path& folder, const fs::path& chosen) {
  std::vector<PatientEntry> entries;
  const auto data = host::FindDataFolder();
  if (data.ok()) {
    entries.push_back(DescribePatient(*data / kBuiltIn));
    // everywhere by the same name
    entries.back().folder.clear();
    entries.back().name = ShortPatientName({});
    entries.back().about = host::Translate("From the Visible Human's pictures; measured and trained on most");
  }
  std::vector<fs::path> folders;
  std::error_code failure;
  for (fs::directory_iterator it(folder, failure), end; !failure && it != end; it.increment(failure)) {
    std::error_code ignored;
    const std::string name = it->path().filename().string();
    // what is being written has a point in its name
    if (it->is_directory(ignored) && name.find('.') == std::string::npos) folders.push_back(it->path());
  }
  std::sort(folders.begin(), folders.end());
  if (!chosen.empty() && std::find(folders.begin(), folders.end(), chosen) == folders.end())
    folders.push_back(chosen);
  for (const fs::path& one : folders) entries.push_back(DescribePatient(one));
  return entries;
}

std::string ShortPatientName(const fs::path& folder) {
  if (folder.empty()) return host::Translate("the built-in patient");
  std::string name = (folder.has_filename() ? folder : folder.parent_path()).filename().string();
  // as the desk names what it generates
  if (name.starts_with(kGenerated) && name.size() > kGenerated.size() &&
      name.find_first_not_of("0123456789", kGenerated.size()) == std::string::npos)
    return host::TranslateWith("generated patient {1}", {name.substr(kGenerated.size())});
  std::replace(name.begin(), name.end(), '-', ' ');
  std::replace(name.begin(), name.end(), '_', ' ');
  return host::TranslateComposed(name);
}

}  // namespace trocar::presenter
