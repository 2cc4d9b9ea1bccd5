// SPDX-License-Identifier: Apache-2.0
#include "hostile_documents.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace trocar::json_doors {
namespace {

using nlohmann::json;

std::string Repeat(std::string_view text, std::size_t count) {
  std::string all;
  all.reserve(text.size() * count);
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

class List {
 public:
  void Add(std::string name, std::string text) { documents.push_back({std::move(name), std::move(text)}); }
  void AddJson(std::string name, std::string text) {
    documents.push_back({std::move(name), std::move(text), true});
  }

  std::vector<HostileDocument> documents;
};

void AddDeep(List& list) {
  for (const std::size_t depth : {65u, 1000u, 100'000u, 1'000'000u}) {
    const std::string levels = std::to_string(depth) + " levels of ";
    list.Add(levels + "lists", Repeat("[", depth) + Repeat("]", depth));
    list.Add(levels + "objects", Repeat("{\"a\":", depth) + "0" + Repeat("}", depth));
    list.Add(levels + "both", Repeat("[{\"a\":", depth / 2 + 1) + "0" + Repeat("}]", depth / 2 + 1));
    list.Add(levels + "open lists", Repeat("[", depth));
  }
  list.Add("depth behind a good beginning",
           R"({"format": "trocar-scene", "version": 1, "name": "a", "organs": )" + Repeat("[", 100'000) +
               Repeat("]", 100'000) + "}");
  list.Add("depth behind a long list", "[" + Repeat("0,", 100'000) + Repeat("[", 100'000));
}

void AddLarge(List& list) {
  std::string many = "{", one = "{";
  for (int i = 0; i < 1'000'000; ++i) many += "\"" + std::to_string(i) + "\":0,";
  for (int i = 0; i < 100'000; ++i) one += "\"a\":0,";
  list.Add("a million fields", many + "\"x\":0}");
  list.Add("one field a hundred thousand times", one + "\"x\":0}");
  list.Add("nine million numbers", "[" + Repeat("0,", 9'000'000) + "0]");
  list.Add("a million small objects", "[" + Repeat(R"({"a":0},)", 1'000'000) + "0]");
  list.Add("a name of two megabytes", "{\"" + std::string(2u << 20, 'n') + "\":0}");
  list.Add("a text of five megabytes", "{\"name\":\"" + std::string(5u << 20, 't') + "\"}");
  list.Add("a text of escapes", "[\"" + Repeat("\\u00e9", 3'000'000) + "\"]");
  list.Add("a text that does not end", "{\"name\":\"" + std::string(3u << 20, 't'));
  list.Add("an array that does not end", Repeat("[0,{},\"\",", 200'000));
}

void AddNumbers(List& list) {
  for (const char* number : {"1e999",
                             "-1e999",
                             "1e99999999999999999999",
                             "NaN",
                             "nan",
                             "-NaN",
                             "Infinity",
                             "-Infinity",
                             "inf",
                             "18446744073709551616",
                             "-9223372036854775809",
                             "100000000000000000000000000000",
                             "0x10",
                             "01",
                             "-01",
                             "+1",
                             ".5",
                             "5.",
                             "-",
                             "--1",
                             "1e",
                             "1e+",
                             "1_000",
                             "1,5",
                             "1.5.2",
                             "\xD9\xA1"})
    list.Add(std::string("the number ") + number, std::string(R"({"version": )") + number + "}");
  list.Add("a number of ten thousand digits", "[" + std::string(10'000, '7') + "]");
  list.Add("a fraction of ten thousand digits", "[0." + std::string(10'000, '7') + "]");
  list.AddJson("no number is smaller", "[1e-999, -0, -0.0, 1.7976931348623157e308]");
}

void AddTexts(List& list) {
  const auto add = [&](const std::string& name, const std::string& inside) {
    list.Add(name, "{\"name\": \"" + inside + "\"}");
  };
  for (const std::string bytes :
       {"\xFF", "\x80", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80",
        "\xF8\x88\x80\x80\x80", "\xC3", "\xE2\x82", "\xF0\x9F\x92"})
    add("bytes that are no UTF-8, " +
            json::binary(std::vector<std::uint8_t>(bytes.begin(), bytes.end())).dump(),
        bytes);
  for (const char* escape : {R"(\ud800)", R"(\udc00)", R"(\ud800\u0041)", R"(\udc00\ud800)", R"(\u12)",
                             R"(\x41)", R"(\u0000)", R"(scene\u0000.json)", R"(\)", R"(\')"})
    add(std::string("the escape ") + escape, escape);
  add("a zero byte in a text", std::string("a\0b", 3));
  add("a line end in a text", "a\nb");
  add("an escape of a terminal", "\x1b[2J");
  list.Add("a name that is no UTF-8", "{\"\xFF\": 1}");
  list.Add("a name with a zero", R"({"a\u0000": 1})");
  list.Add("UTF-16", std::string("\xFF\xFE{\0}\0", 6));
  list.Add("UTF-32", std::string("\0\0\xFE\xFF\0\0\0[\0\0\0]", 12));
  list.Add("two byte order marks", "\xEF\xBB\xBF\xEF\xBB\xBF{}");
  list.Add("half a byte order mark", "\xEF\xBB{}");
  list.AddJson("a byte order mark", "\xEF\xBB\xBF{}");
  list.AddJson("marks that turn the direction of writing", "{\"name\": \"\xE2\x80\xAE\xE2\x81\xA6\"}");
}

void AddSyntax(List& list) {
  for (const char* text :
       {"null", "true", "0", "\"\"", "[]", "{}", "[[]]", "[{}]", R"({"":{}})", R"({"format":null})",
        R"({"format":[],"version":{}})", R"({"__proto__":{"a":1},"constructor":1})"})
    list.AddJson(std::string("of another shape: ") + text, text);
  for (const char* text : {"",
                           " \n\t",
                           "{",
                           "[",
                           "]",
                           "}",
                           "{]",
                           "[}",
                           "[1,]",
                           "{,}",
                           "[,1]",
                           R"({"a":})",
                           R"({"a" 1})",
                           "{a:1}",
                           "{'a':1}",
                           "[1 2]",
                           "{} {}",
                           "{}x",
                           "[]]",
                           "{}}",
                           "// none\n{}",
                           "/* none */ {}",
                           R"({"a":1 "b":2})",
                           R"({"a":1,})",
                           "\"",
                           "\"\\",
                           "nul",
                           "tru",
                           "TRUE",
                           "None",
                           "undefined",
                           "<html></html>",
                           "format: trocar-scene",
                           "{\"a\":1}\n{\"a\":2}\n"})
    list.Add(std::string("no JSON: ") + text, text);
  list.Add("a zero byte behind", std::string("{}\0", 3));
  list.Add("another text behind a zero byte", std::string("{}\0{\"a\":1}", 10));
  list.Add("a zero byte before", std::string("\0{}", 3));
  list.Add("zeros", std::string(100'000, '\0'));
  list.Add("a field twice", R"({"format":"trocar-scene","format":"trocar-task"})");
  list.Add("a field twice, further in", R"({"a":[{"b":{"c":1,"d":2,"c":3}}]})");
  list.Add("a field twice, by an escape", R"({"version":1,"\u0076ersion":2})");
  const std::string good =
      R"({"format": "trocar-x", "list": [1.5e3, {"a": "b\u00e9"}, true, null], "n": -12})";
  for (std::size_t length = 1; length < good.size(); length += 7)
    list.Add("cut after " + std::to_string(length) + " bytes", good.substr(0, length));
}

}  // namespace

std::vector<HostileDocument> MakeHostileDocuments() {
  List list;
  AddDeep(list);
  AddLarge(list);
  AddNumbers(list);
  AddTexts(list);
  AddSyntax(list);
  return std::move(list.documents);
}

std::vector<HostileDocument> MutateSample(std::string_view sample, std::size_t most) {
  const json good = json::parse(sample);
  json deep = 0;
  for (int i = 0; i < 20; ++i) deep = i % 2 == 0 ? json::array({deep}) : json::object({{"a", deep}});
  const std::vector<json> others = {nullptr,
                                    true,
                                    "",
                                    "../../../etc/passwd",
                                    1000000,
                                    -1,
                                    1e308,
                                    1e-300,
                                    std::uint64_t(-1),
                                    0.5,
                                    json::array(),
                                    json::object(),
                                    json::array({json::array()}),
                                    deep,
                                    std::string(2000, 'x')};
  std::vector<std::string> places;
  const json flat = good.flatten();
  for (const auto& [place, value] : flat.items()) {
    // the value itself, and each list or object around it, once
    for (std::string at = place; !at.empty(); at.resize(at.rfind('/'))) {
      if (std::find(places.begin(), places.end(), at) == places.end()) places.push_back(at);
    }
  }
  std::vector<HostileDocument> documents;
  // evenly over the whole text: the steps have no common factor with the number of others
  const std::size_t all = places.size() * (others.size() + 1);
  const std::size_t step = std::max<std::size_t>(1, all / most) | 1;
  for (std::size_t i = 0; i < all && documents.size() < most; i += step) {
    const std::string& place = places[i / (others.size() + 1)];
    const std::size_t other = i % (others.size() + 1);
    json changed = good;
    const json::json_pointer at(place);
    if (other < others.size()) {
      changed[at] = others[other];
    } else {
      json& around = changed[at.parent_pointer()];
      if (around.is_object()) {
        around.erase(at.back());
      } else {
        around.push_back(changed[at]);
      }
    }
    documents.push_back(
        {place + " is " + (other < others.size() ? others[other].dump().substr(0, 60) : "gone or twice"),
         changed.dump(), true});
  }
  return documents;
}

}  // namespace trocar::json_doors
