#include "core/parameters/yaml_parameters.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <regex>
#include <sstream>

namespace fail_aware {
namespace {

std::string place(const std::string& source, const YAML::Mark& mark) {
  return mark.line < 0 ? source + ": " : source + ':' + std::to_string(mark.line + 1) + ": ";
}

bool isOneOf(const std::string& text, std::initializer_list<const char*> words) {
  return std::find(words.begin(), words.end(), text) != words.end();
}

/// The type that YAML 1.1, and therefore rosparam, gives to an unquoted scalar.
ParameterValue plainScalar(const std::string& text) {
  static const std::regex kInt("[-+]?(0|[1-9][0-9]*)");
  static const std::regex kFloat(R"(([-+]?[0-9]+\.[0-9]*|\.[0-9]+)([eE][-+][0-9]+)?)");
  static const std::regex kInf(R"([-+]?\.(inf|Inf|INF))");
  // Text that one of the two readers, or a person, takes for a number and the other reader does not.
  static const std::regex kDoubtful(R"([-+]?[0-9.][0-9_.:]*([eE][-+]?[0-9]+)?|[-+]?0[xXbBoO][0-9a-fA-F_]+)");

  if (isOneOf(text, {"true", "True", "TRUE", "yes", "Yes", "YES", "on", "On", "ON"})) return true;
  if (isOneOf(text, {"false", "False", "FALSE", "no", "No", "NO", "off", "Off", "OFF"})) return false;
  if (isOneOf(text, {".nan", ".NaN", ".NAN"})) throw ParameterError("must not be NaN");
  if (std::regex_match(text, kInt)) {
    int value = 0;
    if (!parseInt(text, value)) throw ParameterError(text + " is out of an int's range");
    return value;
  }
  if (std::regex_match(text, kFloat)) {
    double value = 0.0;
    if (!parseDouble(text, value)) throw ParameterError(text + " is out of a double's range");
    return value;
  }
  if (std::regex_match(text, kInf)) return text[0] == '-' ? -HUGE_VAL : HUGE_VAL;
  if (std::regex_match(text, kDoubtful)) {
    throw ParameterError(text +
                         " is not read as a number everywhere: write 12, 0.5 or 1.0e-3, or quote it if it is text");
  }
  return text;
}

ParameterValue scalar(const YAML::Node& node) {
  const bool quoted = node.Tag() == "!" || node.Tag() == "tag:yaml.org,2002:str";
  return quoted ? ParameterValue(node.Scalar()) : plainScalar(node.Scalar());
}

std::vector<double> numbers(const YAML::Node& node) {
  std::vector<double> list;
  for (const YAML::Node& item : node) {
    const ParameterValue value = item.IsScalar() ? scalar(item) : ParameterValue(std::string());
    if (const int* whole = std::get_if<int>(&value)) {
      list.push_back(*whole);
    } else if (const double* number = std::get_if<double>(&value)) {
      list.push_back(*number);
    } else {
      throw ParameterError("a list may hold numbers only");
    }
  }
  return list;
}

void flatten(const YAML::Node& map, const std::string& prefix, YamlParameters& yaml) {
  for (const auto& item : map) {
    const std::string at = place(yaml.source, item.first.Mark());
    if (!item.first.IsScalar()) throw ParameterError(at + "a key must be a name");
    const std::string& name = item.first.Scalar();
    const std::string key = prefix + name;
    const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
    if (name.empty() || !std::all_of(name.begin(), name.end(), is_word)) {
      throw ParameterError(at + key + ": a key is made of letters, digits and _; groups are nested");
    }
    const YAML::Node& value = item.second;
    if (value.IsNull()) throw ParameterError(at + key + ": has no value");
    if (!yaml.lines.emplace(key, item.first.Mark().line + 1).second) throw ParameterError(at + key + ": given twice");
    if (value.IsMap()) {
      flatten(value, key + '.', yaml);
      continue;
    }
    try {
      yaml.values[key] = value.IsSequence() ? ParameterValue(numbers(value)) : scalar(value);
    } catch (const ParameterError& error) {
      throw ParameterError(at + key + ": " + error.what());
    }
  }
}

class IgnoredEvents : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnAlias(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnScalar(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {}
  void OnSequenceStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {}
  void OnMapEnd() override {}
};

/// The first line, counted from 1, whose indentation has a tab, which yaml does not allow; 0: none.
int lineIndentedByTab(const std::string& text) {
  std::istringstream stream(text);
  int number = 1;
  for (std::string line; std::getline(stream, line); ++number) {
    const std::size_t content = line.find_first_not_of(" \t\r");
    if (content != std::string::npos && line[content] != '#' && line.find('\t') < content) return number;
  }
  return 0;
}

/// YAML::LoadAll never ends on a stray comma: it reads one empty document after the other.
bool isOneDocument(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  IgnoredEvents ignored;
  return !parser.HandleNextDocument(ignored) || !parser.HandleNextDocument(ignored);
}

std::vector<std::string> split(const std::string& key) {
  std::vector<std::string> names;
  std::istringstream stream(key);
  for (std::string name; std::getline(stream, name, '.');) names.push_back(name);
  return names;
}

struct FormatYaml {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(int value) const { return std::to_string(value); }
  std::string operator()(double value) const {
    if (std::isfinite(value)) return formatDouble(value);
    return value < 0.0 ? "-.inf" : ".inf";
  }
  std::string operator()(const std::string& value) const {
    YAML::Emitter emitter;
    emitter << YAML::DoubleQuoted << value;
    return emitter.c_str();
  }
  std::string operator()(const std::vector<double>& list) const {
    std::string text;
    for (const double value : list) text += (text.empty() ? "" : ", ") + (*this)(value);
    return '[' + text + ']';
  }
};

}  // namespace

YamlParameters parseYaml(const std::string& text, const std::string& source) {
  YamlParameters yaml;
  yaml.source = source;
  YAML::Node document;
  try {
    if (!isOneDocument(text)) throw ParameterError(source + ": must hold one yaml document");
    document = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const int tab = lineIndentedByTab(text);
    if (tab > 0) throw ParameterError(source + ':' + std::to_string(tab) + ": a tab indents this line: use blanks");
    throw ParameterError(place(source, error.mark) + error.msg);
  }
  if (document.IsNull()) return yaml;
  if (!document.IsMap()) throw ParameterError(place(source, document.Mark()) + "must be a map of parameters");
  flatten(document, "", yaml);
  return yaml;
}

YamlParameters readYaml(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  const bool has_text = file.peek() != std::ifstream::traits_type::eof();
  if (has_text) text << file.rdbuf();
  if (!file.is_open() || file.bad() || !text) throw ParameterError(path + ": cannot be read");
  return parseYaml(text.str(), path);
}

ParameterError located(const YamlParameters& yaml, const ParameterKeyError& error) {
  const auto line = yaml.lines.find(error.key());
  const std::string where = line == yaml.lines.end() ? yaml.source : yaml.source + ':' + std::to_string(line->second);
  return ParameterError(where + ": " + error.what());
}

std::string formatYaml(const ParameterList& list) {
  std::string text;
  std::vector<std::string> open_groups;
  for (const auto& [key, value] : list) {
    std::vector<std::string> groups = split(key);
    const std::string name = groups.back();
    groups.pop_back();
    const auto common = std::mismatch(groups.begin(), groups.end(), open_groups.begin(), open_groups.end()).first;
    for (auto group = common; group != groups.end(); ++group) {
      text.append(2 * static_cast<std::size_t>(group - groups.begin()), ' ').append(*group + ":\n");
    }
    text.append(2 * groups.size(), ' ').append(name + ": " + std::visit(FormatYaml{}, value) + '\n');
    open_groups = std::move(groups);
  }
  return text;
}

void writeYaml(const std::string& path, const ParameterList& list) {
  std::ofstream file(path, std::ios::binary);
  file << formatYaml(list);
  file.close();
  if (!file) throw ParameterError(path + ": cannot be written");
}

}  // namespace fail_aware
