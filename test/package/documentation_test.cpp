// README and doc/: links resolve, what they name is there, values in tables are those of the code. No test asks for a
// sentence.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "../../src/nodelets/fail_aware_monitor_params.hpp"
#include "../../src/nodelets/fusion_ukf_params.hpp"
#include "../support/tool_run.hpp"
#include "core/io/profile_files.hpp"
#include "core/parameters/parameter_map.hpp"
#include "source_tree.hpp"

namespace fail_aware::documentation_test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> pages() {
  std::vector<std::string> pages = {"README.md", "fleet/README.md"};
  for (const std::string& file : filesBelow("doc")) {
    if (hasEnding(file, ".md")) pages.push_back(file);
  }
  return pages;
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The page's lines outside of code blocks.
std::vector<std::string> proseOf(const std::string& page) {
  std::vector<std::string> prose;
  bool code = false;
  for (const std::string& line : linesOf(readText(sourcePath(page)))) {
    const bool fence = line.find("```") != std::string::npos;
    if (fence) code = !code;
    if (!fence && !code) prose.push_back(line);
  }
  return prose;
}

/// What the pattern's group holds, of each match in each line.
std::vector<std::string> matchesIn(const std::vector<std::string>& lines, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> found;
  for (const std::string& line : lines) {
    for (std::sregex_iterator match(line.begin(), line.end(), regex), end; match != end; ++match) {
      found.push_back((*match)[1]);
    }
  }
  return found;
}

/// The anchor of a heading, as GitHub makes it.
std::string anchorOf(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    const unsigned char letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) || c == '-' || c == '_') anchor += static_cast<char>(std::tolower(letter));
    if (c == ' ') anchor += '-';
  }
  return anchor;
}

std::set<std::string> anchorsOf(const std::string& page) {
  std::set<std::string> anchors;
  for (const std::string& heading : matchesIn(proseOf(page), "^#+ (.+)$")) anchors.insert(anchorOf(heading));
  return anchors;
}

TEST(Documentation, LinksResolve) {
  EXPECT_EQ(anchorOf("Install, build and run the demo"), "install-build-and-run-the-demo");
  std::size_t links = 0;
  for (const std::string& page : pages()) {
    for (const std::string& link : matchesIn(proseOf(page), R"(\]\(([^)\s]+)\))")) {
      if (link.rfind("http", 0) == 0) continue;
      ++links;
      const std::size_t hash = link.find('#');
      const std::string path = link.substr(0, hash);
      const std::string target =
          path.empty() ? page : (fs::path(page).parent_path() / path).lexically_normal().generic_string();
      EXPECT_TRUE(fs::exists(sourcePath(target))) << page << ": " << link;
      if (hash == std::string::npos) continue;
      EXPECT_EQ(anchorsOf(target).count(link.substr(hash + 1)), 1u) << page << ": " << link;
    }
  }
  EXPECT_GT(links, 50u);
}

TEST(Documentation, EveryPageIsLinkedFromTheReadme) {
  const std::vector<std::string> links = matchesIn(proseOf("README.md"), R"(\]\(([^)#\s]+))");
  for (const std::string& page : pages()) {
    EXPECT_TRUE(page == "README.md" || std::count(links.begin(), links.end(), page) > 0) << page;
  }
}

TEST(Documentation, ReadmeIsShortAndSoArePages) {
  const std::vector<std::string> lines = linesOf(readText(sourcePath("README.md")));
  EXPECT_LE(lines.size(), 200u);
  for (const std::string& line : lines) {
    const auto characters =
        std::count_if(line.begin(), line.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
    EXPECT_LE(characters, 120) << line;
  }
  for (const std::string& page : pages()) EXPECT_LE(linesOf(readText(sourcePath(page))).size(), 300u) << page;
}

TEST(Documentation, CommitsAreNamedInTheResultsOnly) {
  for (const std::string& page : pages()) {
    if (page == "doc/results.md") continue;
    for (const std::string& word : matchesIn(linesOf(readText(sourcePath(page))), "\\b([0-9a-f]{7,40})\\b")) {
      const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
      const bool number = std::all_of(word.begin(), word.end(), is_digit);
      EXPECT_TRUE(number || std::none_of(word.begin(), word.end(), is_digit)) << page << ": " << word;
    }
  }
}

/// README's table is the results' one without profile `paper`: one command makes both.
TEST(Documentation, ReadmesFiguresAreThoseOfTheResults) {
  const std::regex row(R"(^\| (\w+) \| (\d[^|]*) \| (?:(\d[^|]*) \| )?(\d[^|]*) \| ([^|]*) \|$)");
  const auto rowsOf = [&](const std::string& page) {
    std::set<std::string> rows;
    for (const std::string& line : proseOf(page)) {
      std::smatch cell;
      if (!std::regex_search(line, cell, row) || line.find(" % ") == std::string::npos) continue;
      EXPECT_EQ(cell[3].matched, page != "README.md") << page << ": " << line;
      rows.insert(cell[1].str() + '|' + cell[2].str() + '|' + cell[4].str() + '|' + cell[5].str());
    }
    return rows;
  };
  EXPECT_GE(rowsOf("README.md").size(), 8u);
  EXPECT_EQ(rowsOf("README.md"), rowsOf("doc/results.md"));
}

TEST(Documentation, NamedFilesAndProgramsExist) {
  const std::string folders = "(?:src|include|test|cfg|scripts|fleet|launch|examples|msg|doc|rviz|\\.ci)/";
  const std::string package = "fail_aware_lidar_odometry ";
  for (const std::string& page : pages()) {
    const std::vector<std::string> lines = linesOf(readText(sourcePath(page)));
    for (const std::string& path : matchesIn(lines, "(?:^|[\\s`'(])(" + folders + "[A-Za-z0-9_./]*[A-Za-z0-9_])")) {
      if (std::regex_search(path, std::regex("[A-Z]{3}"))) continue;  // test/nodelets/NAME.test
      EXPECT_TRUE(fs::exists(sourcePath(path))) << page << ": " << path;
    }
    for (const std::string& name : matchesIn(lines, "rosrun " + package + "([a-z_]+)")) {
      EXPECT_TRUE(fs::exists(sourcePath("src/tools/" + name + ".cpp")) || fs::exists(sourcePath("scripts/" + name)))
          << page << ": rosrun " << name;
    }
    for (const std::string& name : matchesIn(lines, "roslaunch (?:--ros-args )?" + package + "([a-z0-9_]+\\.launch)")) {
      EXPECT_TRUE(fs::exists(sourcePath("launch/" + name))) << page << ": " << name;
    }
  }
}

TEST(Documentation, ReadmeHasTheCommandOfContinuousIntegration) {
  const std::vector<std::string> commands = matchesIn(linesOf(readText(sourcePath(".ci/run"))), "^exec (\\S+)$");
  ASSERT_EQ(commands.size(), 1u);
  EXPECT_NE(readText(sourcePath("README.md")).find("\n" + commands[0]), std::string::npos) << commands[0];
}

// ---- parameters -----------------------------------------------------------------------------------------------------

ParameterMap shippedParameters() {
  ParameterMap shipped = toMap(loadPipelineParameters({FAIL_AWARE_SOURCE_CFG, "default", "passat_b6", "hdl64e"}));
  for (const auto& [key, value] : toMap(FusionUkfNodeletParams())) shipped["fusion_ukf/" + key] = value;
  for (const auto& [key, value] : toMap(FailAwareMonitorNodeletParams())) shipped["fail_aware_monitor/" + key] = value;
  return shipped;
}

bool isValue(const ParameterValue& value, const std::string& told) {
  if (const bool* flag = std::get_if<bool>(&value)) return told == (*flag ? "true" : "false");
  if (const std::string* words = std::get_if<std::string>(&value)) return told == *words;
  if (std::holds_alternative<std::vector<double>>(value)) return told.rfind("[", 0) == 0;
  const double number = std::holds_alternative<int>(value) ? std::get<int>(value) : std::get<double>(value);
  try {
    return std::stod(told) == number;
  } catch (const std::exception&) {
    return false;
  }
}

/// Rows | `key` | value ... | of any page.
TEST(Documentation, ValuesInTablesAreThoseOfTheCode) {
  const ParameterMap shipped = shippedParameters();
  const std::regex row(R"(^\| `([a-z_0-9./]+)` \| ([^|]*?) ?(?:\(paper: .*\) )?\| )");
  std::set<std::string> told;
  for (const std::string& page : pages()) {
    for (const std::string& line : proseOf(page)) {
      std::smatch match;
      if (!std::regex_search(line, match, row) || shipped.count(match[1]) == 0) continue;
      if (page == "README.md" || page == "doc/interfaces.md") continue;  // meanings; services
      told.insert(match[1]);
      EXPECT_TRUE(isValue(shipped.at(match[1]), match[2])) << page << ": " << match[1] << " is not " << match[2];
    }
  }
  for (const auto& [key, value] : shipped) EXPECT_EQ(told.count(key), 1u) << key << " is in no table";
}

/// A key in backticks that begins with a group of the parameters is a key or a group.
TEST(Documentation, NamedKeysExist) {
  std::set<std::string> keys, first;
  for (const auto& [key, value] : shippedParameters()) {
    for (std::size_t at = key.find('.'); at != std::string::npos; at = key.find('.', at + 1)) {
      keys.insert(key.substr(0, at));
    }
    keys.insert(key);
    if (key.find('.') != std::string::npos) first.insert(key.substr(0, key.find('.')));
  }
  for (const std::string& page : pages()) {
    for (const std::string& name : matchesIn(proseOf(page), "`([a-z_0-9]+(?:\\.[a-z_0-9]+)+)(?:: [^`]*|=[^`]*)?`")) {
      if (first.count(name.substr(0, name.find('.'))) == 0) continue;
      EXPECT_EQ(keys.count(name), 1u) << page << ": " << name;
    }
  }
}

TEST(Documentation, ParameterPagesAreWhatTheScriptMakes) {
  const fs::path folder = fs::path(::testing::TempDir()) / ("parameter_page_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const ToolRun run = runProgram(sourcePath("scripts/generate_parameter_page"), "--check", folder);
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_EQ(runProgram(sourcePath("scripts/generate_parameter_page"), "--verify", folder).exit_code, 2);
  fs::remove_all(folder);
}

// ---- troubleshooting ------------------------------------------------------------------------------------------------

TEST(Documentation, TroubleshootingHasEveryReason) {
  const std::string page = readText(sourcePath("doc/troubleshooting.md"));
  const std::vector<std::string> reasons =
      matchesIn(linesOf(readText(sourcePath("msg/TimeToFailure.msg"))), "^uint32 REASON_([A-Z_]+) =");
  EXPECT_GE(reasons.size(), 20u);
  for (const std::string& reason : reasons) EXPECT_NE(page.find("`" + reason + "`"), std::string::npos) << reason;
}

TEST(Documentation, EveryStateIsInTheContract) {
  const std::string page = readText(sourcePath("doc/planner_contract.md"));
  for (const std::string& state :
       matchesIn(linesOf(readText(sourcePath("msg/TimeToFailure.msg"))), "^uint8 ([A-Z]+) =")) {
    EXPECT_NE(page.find("\n| `" + state + "` |"), std::string::npos) << state;
  }
}

/// What the nodelets' diagnostics say: warnings, errors, and the names of values.
TEST(Documentation, TroubleshootingHasEveryDiagnostic) {
  const std::string page = readText(sourcePath("doc/troubleshooting.md"));
  std::size_t found = 0;
  for (const std::string& file : filesBelow("src/nodelets")) {
    const std::vector<std::string> lines = linesOf(readText(sourcePath(file)));
    std::vector<std::string> said = matchesIn(lines, "::(?:WARN|ERROR), \"([^\"%:]+)");
    for (const std::string& value : matchesIn(lines, "status\\.addf?\\((?:source\\.name \\+ )?\"(?:: )?([^\"]+)\"")) {
      said.push_back(value);
    }
    for (std::string text : said) {
      text.erase(text.find_last_not_of(' ') + 1);
      ++found;
      if (text.rfind("dropped", 0) == 0 && hasEnding(text, ":")) continue;  // its causes follow
      EXPECT_NE(page.find(text), std::string::npos) << file << ": " << text;
    }
  }
  EXPECT_GT(found, 40u);
}

}  // namespace
}  // namespace fail_aware::documentation_test
