// scripts/dependencies.txt and package.xml name the same dependencies.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "fail_aware_lidar_odometry/version.hpp"
#include "source_tree.hpp"

namespace fail_aware::dependencies_test {
namespace {

struct DependencyList {
  std::set<std::string> rosdep_keys;
  std::set<std::string> debian_packages;
};

DependencyList readList() {
  DependencyList list;
  std::istringstream text(readText(sourcePath("scripts/dependencies.txt")));
  for (std::string line; std::getline(text, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream columns(line);
    std::string key, package, rest;
    EXPECT_TRUE(columns >> key >> package) << "two columns: " << line;
    EXPECT_TRUE(!(columns >> rest) || rest == "plain") << line;
    if (key != "-") list.rosdep_keys.insert(key);
    EXPECT_TRUE(list.debian_packages.insert(package).second) << package << " is listed twice";
  }
  return list;
}

std::set<std::string> readManifest() {
  const std::string text = std::regex_replace(readText(sourcePath("package.xml")), std::regex("<!--[^]*?-->"), "");
  const std::regex depend("<((?:[a-z]+_)*depend)(?:\\s[^>]*)?>\\s*([^<\\s]+)\\s*</\\1>");
  std::set<std::string> keys;
  for (std::sregex_iterator match(text.begin(), text.end(), depend), end; match != end; ++match) {
    keys.insert((*match)[2]);
  }
  return keys;
}

TEST(Dependencies, ListAndManifestAgree) {
  const std::set<std::string> manifest = readManifest();
  EXPECT_EQ(manifest.count("catkin"), 1u);
  EXPECT_EQ(readList().rosdep_keys, manifest);
}

TEST(Dependencies, ListNamesTheToolsOfABareSystem) {
  const DependencyList list = readList();
  for (const char* package : {"g++", "cmake", "make", "python3", "catkin"}) {
    EXPECT_EQ(list.debian_packages.count(package), 1u) << package;
  }
}

TEST(Dependencies, VersionsAgree) {
  std::smatch manifest, project;
  const std::string xml = readText(sourcePath("package.xml")), lists = readText(sourcePath("CMakeLists.txt"));
  ASSERT_TRUE(std::regex_search(xml, manifest, std::regex("<version>([0-9.]+)</version>")));
  ASSERT_TRUE(std::regex_search(lists, project, std::regex("project\\([^)]*VERSION ([0-9.]+)")));
  EXPECT_EQ(manifest[1], project[1]);
  EXPECT_EQ(manifest[1], FAIL_AWARE_LIDAR_ODOMETRY_VERSION);
  std::ostringstream parts;
  parts << FAIL_AWARE_LIDAR_ODOMETRY_VERSION_MAJOR << '.' << FAIL_AWARE_LIDAR_ODOMETRY_VERSION_MINOR << '.'
        << FAIL_AWARE_LIDAR_ODOMETRY_VERSION_PATCH;
  EXPECT_EQ(parts.str(), FAIL_AWARE_LIDAR_ODOMETRY_VERSION);
  EXPECT_NE(readText(sourcePath("CHANGELOG.rst")).find("\n" + parts.str() + " "), std::string::npos);
}

}  // namespace
}  // namespace fail_aware::dependencies_test
