// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/rating.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "trocar/host/data_folder.h"
#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/translate.h"
#include "trocar/scene/scene.h"

namespace trocar::report {
namespace {

constexpr const char* kFormFormat = "trocar-rating-form";
constexpr const char* kRatingFormat = "trocar-rating";

base::Error Invalid(const std::string& what) {
  return {base::ErrorCode::kRatingInvalid, what};
}

const RatingItem* FindItem(const RatingForm& form, std::string_view key) {
  const auto found = std::find_if(form.items.begin(), form.items.end(),
                                  [&](const RatingItem& item) { return item.key == key; });
  return found == form.items.end() ? nullptr : &*found;
}

base::Result<std::vector<std::pair<std::string, int>>> OrderPoints(const RatingForm& form,
                                                                   const std::map<std::string, int>& given) {
  std::vector<std::pair<std::string, int>> points;
  for (const RatingItem& item : form.items) {
    const auto found = given.find(item.key);
    if (found == given.end())
      return Invalid("no points for \"" + item.key + "\"; " + form.name + " needs all of its " +
                     std::to_string(form.items.size()) + " items");
    points.emplace_back(item.key, found->second);
  }
  return points;
}

}  // namespace

int Rating::Sum() const {
  return std::accumulate(points.begin(), points.end(), 0,
                         [](int sum, const auto& item) { return sum + item.second; });
}

std::vector<std::string> ListRatingForms() {
  std::vector<std::string> keys;
  const auto data = host::FindDataFolder();
  if (!data.ok()) return keys;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(*data / "assets" / "rating", failure)) {
    if (entry.path().extension() == ".json") keys.push_back(entry.path().stem().string());
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

base::Result<RatingForm> ReadRatingForm(const std::filesystem::path& path) {
  auto document = host::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const host::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "key", "name", "about", "source", "items"});
  if (root.Text("format") != kFormFormat)
    root.Complain(std::string("is no form for ratings: \"format\" must be \"") + kFormFormat + "\"");
  if (root.Integer("version") != 1) root.Complain("is of another version; this program reads version 1");
  RatingForm form{root.Text("key"), root.Text("name"), root.Text("about"), root.Text("source"), {}};
  for (const host::JsonView& element : root.Array("items")) {
    element.AllowOnly({"key", "name", "1", "3", "5"});
    RatingItem item{element.Text("key"), element.Text("name"), element.Text("1"), element.Text("3"),
                    element.Text("5")};
    if (FindItem(form, item.key) != nullptr) element.Complain("the key is given twice");
    form.items.push_back(std::move(item));
  }
  if (form.items.empty()) root.Complain("has no items");
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return form;
}

base::Result<RatingForm> FindRatingForm(const std::string& key_or_path) {
  const std::vector<std::string> known = ListRatingForms();
  if (std::find(known.begin(), known.end(), key_or_path) != known.end()) {
    const auto data = host::FindDataFolder();
    if (!data.ok()) return data.error();
    return ReadRatingForm(*data / "assets" / "rating" / (key_or_path + ".json"));
  }
  std::error_code failure;
  if (std::filesystem::is_regular_file(key_or_path, failure)) return ReadRatingForm(key_or_path);
  std::string list;
  for (const std::string& key : known) list += (list.empty() ? "" : ", ") + key;
  return base::Error{base::ErrorCode::kUnknownName, "there is no rating form \"" + key_or_path +
                                                        "\"; there are " + list + ", or a file of your own"};
}

base::Result<std::vector<std::pair<std::string, int>>> ParsePoints(const RatingForm& form,
                                                                   const std::vector<std::string>& words) {
  std::map<std::string, int> given;
  for (const std::string& word : words) {
    const std::size_t sign = word.find('=');
    int points = 0;
    const char* end = word.data() + word.size();
    if (sign == std::string::npos || std::from_chars(word.data() + sign + 1, end, points).ptr != end ||
        sign + 1 == word.size())
      return Invalid("\"" + word + "\" is not like depth_perception=4");
    const std::string key = word.substr(0, sign);
    if (FindItem(form, key) == nullptr) return Invalid(form.name + " has no item \"" + key + "\"");
    if (points < kLeastPoints || points > kMostPoints)
      return Invalid("\"" + word + "\": points go from 1 to 5");
    if (!given.emplace(key, points).second) return Invalid("\"" + key + "\" is given twice");
  }
  return OrderPoints(form, given);
}

base::Result<Rating> ReadRating(const std::filesystem::path& path) {
  auto document = host::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const host::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "form", "attempt", "rater", "rated", "remarks", "points", "sum"});
  if (root.Text("format") != kRatingFormat)
    root.Complain(std::string("is no rating: \"format\" must be \"") + kRatingFormat + "\"");
  if (root.Integer("version") != 1) root.Complain("is of another version; this program reads version 1");
  Rating rating{root.Text("form"),        root.Text("attempt"),       root.Text("rater"),
                root.TextOr("rated", ""), root.TextOr("remarks", ""), {}};
  const int sum = root.Integer("sum");
  std::map<std::string, int> given;
  const host::JsonView points = root.Object("points");
  for (const std::string& key : points.Keys()) given[key] = points.Integer(key, {kLeastPoints, kMostPoints});
  if (const auto status = document->Check(); !status.ok()) return status.error();
  const auto form = FindRatingForm(rating.form);
  if (!form.ok()) return form.error();
  for (const auto& [key, value] : given) {
    if (FindItem(*form, key) == nullptr)
      return Invalid(path.string() + ": " + form->name + " has no item \"" + key + "\"");
  }
  auto ordered = OrderPoints(*form, given);
  if (!ordered.ok()) return Invalid(path.string() + ": " + ordered.error().message);
  rating.points = std::move(*ordered);
  if (sum != rating.Sum())
    return Invalid(path.string() + ": the sum is not that of the points; correct whichever is wrong");
  return rating;
}

std::string FormatRating(const Rating& rating) {
  nlohmann::ordered_json json = {{"format", kRatingFormat},
                                 {"version", 1},
                                 {"form", rating.form},
                                 {"attempt", rating.attempt},
                                 {"rater", rating.rater}};
  if (!rating.rated.empty()) json["rated"] = rating.rated;
  if (!rating.remarks.empty()) json["remarks"] = rating.remarks;
  json["points"] = nlohmann::ordered_json::object();
  for (const auto& [key, points] : rating.points) json["points"][key] = points;
  json["sum"] = rating.Sum();
  return host::FormatJson(json, 2) + "\n";
}

Document MakeRatingSheet(const RatingForm& form) {
  const std::string line = "______________________";
  Document document;
  document.title = host::Translate(form.name);
  document.subtitle = host::Translate("Rating of an attempt");
  document.head = {{host::Translate("Trainee"), line},
                   {host::Translate("Attempt"), line},
                   {host::Translate("Rater"), line},
                   {host::Translate("Date"), line}};
  Section section{host::Translate("Mark one box for each item"), {}};
  section.blocks.emplace_back(Paragraph{host::Translate(form.about), Tone::kPlain});
  Table table{host::Translate("From 1 (least) to 5 (most)"),
              {{host::Translate("Item"), false, 1.5},
               {"1", false, 2},
               {"2", false, 0.5},
               {"3", false, 2},
               {"4", false, 0.5},
               {"5", false, 2}},
              {}};
  for (const RatingItem& item : form.items)
    table.rows.push_back({{host::Translate(item.name)},
                          {"☐ " + host::Translate(item.lowest)},
                          {"☐"},
                          {"☐ " + host::Translate(item.middle)},
                          {"☐"},
                          {"☐ " + host::Translate(item.highest)}});
  section.blocks.emplace_back(std::move(table));
  const auto items = static_cast<int>(form.items.size());
  section.blocks.emplace_back(
      Facts{{{host::Translate("Sum"),
              host::TranslateWith("______ of {1} (at least {2})", {std::to_string(items * kMostPoints),
                                                                   std::to_string(items * kLeastPoints)})},
             {host::Translate("Remarks"), line + line + line}}});
  document.sections.push_back(std::move(section));
  document.sections.push_back({host::Translate("Source"), {Paragraph{form.source, Tone::kMuted}}});
  document.footer = host::TranslateWith(
      "Trocar · {1} · a rating by a person, beside the measures of the simulator", {form.name});
  return document;
}

base::Result<FormAgreement> CompareRatings(const RatingForm& form, const std::vector<Rating>& ratings,
                                           double confidence) {
  std::set<std::string> attempts, raters;
  std::map<std::pair<std::string, std::string>, const Rating*> of;
  for (const Rating& rating : ratings) {
    if (rating.form != form.key)
      return Invalid("ratings of " + form.key + " and " + rating.form +
                     " cannot be compared; give those of one form");
    attempts.insert(rating.attempt);
    raters.insert(rating.rater);
    if (!of.emplace(std::pair{rating.attempt, rating.rater}, &rating).second)
      return Invalid("rater " + rating.rater + " rated " + rating.attempt + " twice; leave one out");
  }
  FormAgreement agreement{{attempts.begin(), attempts.end()}, {raters.begin(), raters.end()}, {}};
  std::vector<std::vector<double>> values(form.items.size() + 1);  // sum, then items
  for (const std::string& attempt : attempts) {
    for (const std::string& rater : raters) {
      const auto found = of.find({attempt, rater});
      if (found == of.end())
        return Invalid("rater " + rater + " did not rate " + attempt +
                       "; all must have rated the same attempts");
      values[0].push_back(found->second->Sum());
      for (std::size_t i = 0; i < form.items.size(); ++i)
        values[i + 1].push_back(found->second->points[i].second);
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto icc = CalcAgreement(values[i], raters.size(), confidence);
    if (icc.ok()) {
      agreement.of.emplace_back(i == 0 ? "sum" : form.items[i - 1].key, *icc);
    } else if (i == 0) {
      return icc.error();
    }
  }
  return agreement;
}

}  // namespace trocar::report
