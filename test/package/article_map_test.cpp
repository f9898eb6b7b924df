// doc/article_map.md, from the article's equations to files: each equation stands in it once, each named file has its
// header and test, each named test is in the test of a file of its row, and each folder of the core stands in
// the map.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

std::string contentOf(const fs::path& path) {
  std::ifstream file(path);
  std::stringstream content;
  content << file.rdbuf();
  return content.str();
}

/// The rows of the page's tables, without their heads.
std::string rowsOfTheMap() {
  std::istringstream lines(contentOf(fs::path(FAIL_AWARE_SOURCE_DIR) / "doc/article_map.md"));
  std::string rows, previous;
  for (std::string line; std::getline(lines, line); previous = line) {
    if (line.rfind("| ", 0) == 0 && previous.rfind("|", 0) == 0) rows += line + '\n';
  }
  return rows;
}

/// Below include/, src/ and test/: most files of the map are of the core.
fs::path inTree(const std::string& name) { return (name.rfind("evaluation/", 0) == 0 ? "" : "core/") + name; }

/// `folder/name`, and `name` after one in the same line: in that folder.
std::vector<std::string> namedFiles(const std::string& section) {
  static const std::regex quoted("`((?:[a-z_]+/)+)?([a-z_]+)`");
  std::vector<std::string> names;
  std::istringstream lines(section);
  for (std::string line; std::getline(lines, line);) {
    std::string folder;
    for (std::sregex_iterator it(line.begin(), line.end(), quoted), end; it != end; ++it) {
      if ((*it)[1].matched) folder = (*it)[1];
      if (folder == "scripts/") continue;
      names.push_back(folder + (*it)[2].str());
    }
  }
  return names;
}

constexpr int kEquations = 24;  // of the article

TEST(ArticleMap, EveryEquationHasItsRowAndEveryRowItsTest) {
  static const std::regex equation(R"(\((\d+)\))"), test("`([A-Z][A-Za-z0-9]+)\\.([A-Za-z0-9]+)`");
  std::multiset<int> equations;
  std::istringstream lines(rowsOfTheMap());
  for (std::string line; std::getline(lines, line);) {
    if (std::count(line.begin(), line.end(), '|') != 4) continue;  // not in the article
    const std::string article = line.substr(0, line.find('|', 1));
    for (std::sregex_iterator it(article.begin(), article.end(), equation), end; it != end; ++it) {
      equations.insert(std::stoi((*it)[1]));
    }
    std::string tests_of_row;
    for (const std::string& name : namedFiles(line)) {
      tests_of_row += contentOf(fs::path(FAIL_AWARE_SOURCE_DIR) / "test" / inTree(name + "_test.cpp"));
    }
    int named = 0;
    for (std::sregex_iterator it(line.begin(), line.end(), test), end; it != end; ++it, ++named) {
      const std::string written = "(" + (*it)[1].str() + ", " + (*it)[2].str() + ")";
      EXPECT_NE(tests_of_row.find(written), std::string::npos) << written << " in " << line;
    }
    EXPECT_GT(named, 0) << line;
  }
  for (int number = 1; number <= kEquations; ++number) EXPECT_EQ(equations.count(number), 1u) << number;
  EXPECT_EQ(equations.size(), static_cast<std::size_t>(kEquations));
}

TEST(ArticleMap, EveryNamedFileHasItsHeaderAndTest) {
  const fs::path root = FAIL_AWARE_SOURCE_DIR;
  const std::vector<std::string> names = namedFiles(rowsOfTheMap());
  EXPECT_GT(names.size(), 20u);
  std::set<std::string> folders;
  for (const std::string& name : names) {
    folders.insert(name.substr(0, name.find('/')));
    for (const fs::path& path : {root / "src" / inTree(name + ".hpp"), root / "test" / inTree(name + "_test.cpp")}) {
      EXPECT_TRUE(fs::exists(path)) << path;
    }
  }
  for (const fs::directory_entry& folder : fs::directory_iterator(root / "src/core")) {
    const std::string name = folder.path().filename();
    if (!folder.is_directory() || name == "io" || name == "parameters" || name == "types") continue;
    EXPECT_EQ(folders.count(name), 1u) << name << " is not in the map";
  }
}

}  // namespace
