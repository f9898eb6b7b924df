// The layers of the package and the folders of the core: what each may include, and that every file is where its name
// says and is built.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "source_tree.hpp"

namespace fail_aware::layering_test {
namespace {

const std::string kInclude = "include/fail_aware_lidar_odometry/";

std::vector<std::string> sourcesBelow(const std::vector<std::string>& folders) {
  std::vector<std::string> sources;
  for (const std::string& folder : folders) {
    for (const std::string& file : filesBelow(folder)) {
      if (hasEnding(file, ".hpp") || hasEnding(file, ".cpp")) sources.push_back(file);
    }
  }
  return sources;
}

std::vector<std::string> includesOf(const std::string& text) {
  static const std::regex kDirective(R"re((?:^|\n)[ \t]*#[ \t]*include[ \t]*[<"]([^>"]+)[>"])re");
  std::vector<std::string> includes;
  for (std::sregex_iterator match(text.begin(), text.end(), kDirective), end; match != end; ++match) {
    includes.push_back((*match)[1]);
  }
  return includes;
}

/// A header of the language or of a library that the core may use. The list is short on purpose: ROS is not on it.
bool coreMayInclude(const std::string& header) {
  static const std::regex kAllowed(
      "[a-z_]+"                                           // the standard library
      "|core/.+"                                          // the core itself
      "|fail_aware_lidar_odometry/[a-z]+\\.hpp"           // its public headers
      "|dlfcn\\.h"                                        // where the library lies
      "|[a-z_]+\\.hpp"                                    // private, beside its source
      "|(Eigen|tbb|tsl|yaml-cpp|embree3|sanitizer)/.+");  // libraries
  return std::regex_match(header, kAllowed);
}

const std::string kCore = "core/";

/// Files in no folder that every folder may include and that include nothing of the core themselves.
const std::set<std::string> kHelpers = {"moving_median", "parallel", "robust_kernel", "stamp_difference"};

/// A folder of the core (or, where there is none, a header with its source) and what it may include beside the helpers.
struct CoreFolder {
  std::string name;
  std::set<std::string> may_include;
};

/// From the bottom to the top: an entry may only name entries above it in this list, so there are no circles.
const std::vector<CoreFolder> kCoreFolders = {
    {"geometry", {}},
    {"types", {"geometry"}},
    {"parameters", {"geometry"}},
    {"preprocessing", {"geometry", "types", "parameters"}},
    {"map", {"geometry", "types", "parameters", "preprocessing"}},
    {"registration", {"geometry", "types", "parameters", "preprocessing", "map"}},
    {"initial_guess", {"geometry", "types", "parameters", "preprocessing", "map", "registration"}},
    {"aiding", {"geometry", "types", "parameters", "preprocessing", "map", "registration", "initial_guess"}},
    {"registration_parameters",
     {"geometry", "types", "parameters", "preprocessing", "map", "registration", "initial_guess", "aiding"}},
    {"local_map_registration",
     {"geometry", "types", "parameters", "preprocessing", "map", "registration", "initial_guess", "aiding",
      "registration_parameters"}},
    {"estimation", {"geometry", "types", "parameters"}},
    {"integrity", {"geometry", "types", "parameters", "estimation"}},
    {"pipeline_parameters",
     {"geometry", "types", "parameters", "preprocessing", "registration_parameters", "estimation", "integrity"}},
    {"estimator", {"geometry", "types", "parameters", "estimation", "pipeline_parameters"}},
    {"odometry_pipeline",
     {"geometry", "types", "parameters", "preprocessing", "registration", "local_map_registration", "estimation",
      "integrity", "pipeline_parameters", "estimator"}},
    {"io", {"geometry", "types", "parameters", "pipeline_parameters"}},
    {"odometry", {"io", "types", "odometry_pipeline"}},
};

/// The helper or the entry of kCoreFolders that a path below include/.../core or src/core belongs to.
std::string coreFolderOf(const std::string& path) { return path.substr(0, std::min(path.find('/'), path.find('.'))); }

/// Null: a helper, or not in the list.
const CoreFolder* findCoreFolder(const std::string& name) {
  const auto found = std::find_if(kCoreFolders.begin(), kCoreFolders.end(),
                                  [&](const CoreFolder& folder) { return folder.name == name; });
  return found == kCoreFolders.end() ? nullptr : &*found;
}

bool coreFolderMayInclude(const std::string& folder, const std::string& other) {
  if (folder == other) return true;
  const CoreFolder* entry = findCoreFolder(folder);
  return entry != nullptr && (kHelpers.count(other) == 1 || entry->may_include.count(other) == 1);
}

TEST(Layering, RulesTellRosFromTheRest) {
  for (const char* header : {"vector", "Eigen/Core", "tbb/task_arena.h", "core/types/measurement.hpp"}) {
    EXPECT_TRUE(coreMayInclude(header)) << header;
  }
  for (const char* header :
       {"ros/ros.h", "ros/time.h", "sensor_msgs/PointCloud2.h", "pcl_ros/point_cloud.h", "tf2/utils.h",
        "pcl_conversions/pcl_conversions.h", "nodelet/nodelet.h", "fail_aware_lidar_odometry/FilterState.h",
        "fail_aware_lidar_odometry/bridge/parameters.hpp", "sys/time.h"}) {
    EXPECT_FALSE(coreMayInclude(header)) << header;
  }
  EXPECT_EQ(includesOf("#include <a>\n  # include \"b.h\" // x\n// #include <c>\n"),
            (std::vector<std::string>{"a", "b.h"}));
}

TEST(Layering, CoreIncludesNothingOfRos) {
  const std::vector<std::string> sources = sourcesBelow({"src/core"});
  ASSERT_FALSE(sources.empty());
  for (const std::string& file : sources) {
    for (const std::string& header : includesOf(readText(sourcePath(file)))) {
      EXPECT_TRUE(coreMayInclude(header)) << file << " includes " << header;
    }
  }
}

TEST(Layering, AFolderOfTheCoreMayIncludeEarlierOnesOnly) {
  std::set<std::string> earlier;
  for (const CoreFolder& folder : kCoreFolders) {
    for (const std::string& other : folder.may_include) {
      EXPECT_EQ(earlier.count(other), 1u) << folder.name << " may include " << other << ", which is not earlier";
    }
    EXPECT_EQ(kHelpers.count(folder.name), 0u) << folder.name;
    EXPECT_TRUE(earlier.insert(folder.name).second) << folder.name << " is listed twice";
  }
}

TEST(Layering, RulesTellForwardsFromBackwards) {
  EXPECT_EQ(coreFolderOf("preprocessing/timing.hpp"), "preprocessing");
  EXPECT_EQ(coreFolderOf("odometry_pipeline.cpp"), "odometry_pipeline");
  EXPECT_TRUE(coreFolderMayInclude("map", "map"));
  EXPECT_TRUE(coreFolderMayInclude("map", "types"));
  EXPECT_TRUE(coreFolderMayInclude("integrity", "estimation"));
  EXPECT_FALSE(coreFolderMayInclude("estimation", "integrity"));
  EXPECT_FALSE(coreFolderMayInclude("preprocessing", "estimation"));
  EXPECT_FALSE(coreFolderMayInclude("estimation", "registration"));
  EXPECT_FALSE(coreFolderMayInclude("types", "estimation"));
  EXPECT_TRUE(coreFolderMayInclude("preprocessing", "moving_median"));
  EXPECT_FALSE(coreFolderMayInclude("moving_median", "parallel"));
  EXPECT_FALSE(coreFolderMayInclude("no_such_folder", "types"));
}

TEST(Layering, FoldersOfTheCoreIncludeInOneDirection) {
  for (const std::string& root : {std::string("src/core")}) {
    for (const std::string& file : sourcesBelow({root})) {
      const std::string folder = coreFolderOf(file.substr(root.size() + 1));
      EXPECT_TRUE(kHelpers.count(folder) == 1 || findCoreFolder(folder) != nullptr)
          << file << " is in no listed folder";
      for (const std::string& header : includesOf(readText(sourcePath(file)))) {
        if (header.rfind(kCore, 0) != 0) continue;
        const std::string other = coreFolderOf(header.substr(kCore.size()));
        EXPECT_TRUE(coreFolderMayInclude(folder, other)) << file << " includes " << header;
      }
    }
  }
}

TEST(Layering, EveryListedFolderOfTheCoreExists) {
  const auto exists = [](const std::string& path) { return std::filesystem::exists(sourcePath(path)); };
  for (const CoreFolder& folder : kCoreFolders) {
    const std::string path = "src/core/" + folder.name;
    EXPECT_TRUE(exists(path) || exists(path + ".hpp") || exists(kInclude + folder.name + ".hpp")) << folder.name;
  }
  for (const std::string& helper : kHelpers) EXPECT_TRUE(exists("src/core/" + helper + ".hpp")) << helper;
}

/// They are libraries over the core; the core's own headers are checked by coreMayInclude().
TEST(Layering, NothingOnTheVehicleIncludesEvaluationOrSimulation) {
  for (const std::string& file : sourcesBelow({kInclude + "bridge", "src/bridge", "src/nodelets"})) {
    for (const std::string& header : includesOf(readText(sourcePath(file)))) {
      EXPECT_EQ(header.rfind("evaluation/", 0), std::string::npos) << file << ": " << header;
      EXPECT_EQ(header.rfind("simulation/", 0), std::string::npos) << file << ": " << header;
    }
  }
}

TEST(Layering, EvaluationAndSimulationIncludeTheCoreAndThemselves) {
  for (const std::string library : {"evaluation", "simulation"}) {
    const std::regex allowed(
        "(?:nlopt|embree3/.+|[a-z_]+|Eigen/.+|tbb/.+)(?:\\.h)?|[a-z_]+\\.hpp|fail_aware_lidar_odometry/"
        "[a-z]+\\.hpp|(?:core|" +
        library + ")/.+");
    for (const std::string& file : sourcesBelow({"src/" + library})) {
      for (const std::string& header : includesOf(readText(sourcePath(file)))) {
        EXPECT_TRUE(std::regex_match(header, allowed)) << file << " includes " << header;
      }
    }
  }
}

TEST(Layering, CoreHasNoClockNoLogAndNoUnseededRandomness) {
  const std::regex forbidden(
      R"(std::c(out|err|log)\b|\bprintf\(|\bsystem_clock\b|\bsteady_clock\b|\brandom_device\b|\brand\(|\btime\()"
      R"(|\bdefault_random_engine\b|\bROS_[A-Z]+)");
  // The pipeline's stopwatch: it reports durations and steers nothing.
  const std::set<std::string> stopwatch = {"src/core/odometry_pipeline.cpp"};
  for (const std::string& file : sourcesBelow({kInclude + "core", kInclude + "evaluation", kInclude + "simulation",
                                               "src/core", "src/evaluation", "src/simulation"})) {
    const std::string text = readText(sourcePath(file));
    for (std::sregex_iterator match(text.begin(), text.end(), forbidden), end; match != end; ++match) {
      EXPECT_TRUE(match->str() == "steady_clock" && stopwatch.count(file) == 1) << file << " uses " << match->str();
    }
  }
}

TEST(Layering, ToolsAndBridgeKnowNoNodelets) {
  for (const std::string& file : sourcesBelow({kInclude + "bridge", "src/bridge", "src/tools"})) {
    for (const std::string& header : includesOf(readText(sourcePath(file)))) {
      EXPECT_NE(header.rfind("nodelet/", 0), 0u) << file << " includes " << header;
    }
  }
}

TEST(Layering, OnlyTheBridgeReadsTheParameterServer) {
  const std::regex reads(R"((\.|->|::)(getParam(Cached)?|param)\s*[(<])");
  for (const std::string& file : sourcesBelow({"src/nodelets", "src/tools"})) {
    EXPECT_FALSE(std::regex_search(readText(sourcePath(file)), reads)) << file;
  }
}

const std::set<std::string> kPublicHeaders = {"monitor.hpp", "odometry.hpp", "parameters.hpp",
                                              "result.hpp",  "sweep.hpp",    "version.hpp"};

/// What a C++ user of the library includes: no TBB, no robin_map, no yaml, nothing of the core's inside.
TEST(Layering, PublicHeadersIncludeEachOtherAndEigen) {
  std::set<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(sourcePath(kInclude))) {
    if (!entry.is_regular_file()) continue;
    found.insert(entry.path().filename().string());
    for (const std::string& header : includesOf(readText(entry.path()))) {
      EXPECT_TRUE(std::regex_match(header, std::regex("[a-z]+|Eigen/.+|fail_aware_lidar_odometry/[a-z]+\\.hpp")))
          << entry.path() << " includes " << header;
    }
  }
  EXPECT_EQ(found, kPublicHeaders);
}

bool hasHeader(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  return std::filesystem::exists(sourcePath(kInclude + path)) || std::filesystem::exists(sourcePath("src/" + path)) ||
         kPublicHeaders.count(name) == 1;
}

TEST(Layering, EverySourceAndTestHasItsHeader) {
  for (const std::string layer : {"core", "bridge", "evaluation", "simulation"}) {
    for (const std::string& file : filesBelow("src/" + layer)) {
      if (!hasEnding(file, ".cpp")) continue;
      const std::string header = file.substr(4, file.size() - 8) + ".hpp";
      EXPECT_TRUE(hasHeader(header)) << file << " has no " << header;
    }
    for (const std::string& file : filesBelow("test/" + layer)) {
      if (!hasEnding(file, "_test.cpp")) continue;
      const std::string header = file.substr(5, file.size() - 14) + ".hpp";
      EXPECT_TRUE(hasHeader(header)) << file << " has no " << header;
    }
  }
}

TEST(Layering, EveryFolderOfTheCoreHasTests) {
  for (const auto& folder : std::filesystem::directory_iterator(sourcePath("src/core"))) {
    if (!folder.is_directory()) continue;
    const std::string tests = "test/core/" + folder.path().filename().string();
    EXPECT_FALSE(filesBelow(tests).empty()) << tests << " is missing or empty";
  }
}

TEST(Layering, EveryHeaderHasAGuardAndSaysWhatItIs) {
  for (const std::string& file :
       sourcesBelow({"include", "src/core", "src/evaluation", "src/simulation", "src/bridge"})) {
    if (!hasEnding(file, ".hpp")) continue;
    const std::string text = readText(sourcePath(file));
    EXPECT_TRUE(text.rfind("// ", 0) == 0) << file << " does not begin with a comment";
    EXPECT_TRUE(text.find("#pragma once") != std::string::npos) << file << " has no #pragma once";
  }
}

/// Its CMakeLists.txt, or one of a folder above, names it or takes all sources of the folder.
bool isInTheBuild(const std::filesystem::path& file) {
  const std::string stem = std::regex_replace(file.stem().string(), std::regex("_test$"), "");
  for (std::filesystem::path folder = file.parent_path(); !folder.empty(); folder = folder.parent_path()) {
    const std::string list = readText(sourcePath((folder / "CMakeLists.txt").string()));
    if (list.find("fail_aware_sources(sources ${CMAKE_CURRENT_SOURCE_DIR})") != std::string::npos) return true;
    if (std::regex_search(list, std::regex("[\\s(/]" + stem + "(_test)?(\\.cpp)?[\\s)]"))) return true;
  }
  return false;
}

TEST(Layering, EverySourceIsInTheBuild) {
  for (const std::string& file : sourcesBelow({"src", "test"})) {
    EXPECT_TRUE(!hasEnding(file, ".cpp") || isInTheBuild(file)) << file << " is in no CMakeLists.txt";
  }
}

}  // namespace
}  // namespace fail_aware::layering_test
