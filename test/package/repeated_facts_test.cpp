// What stands in several places, since launch files, scripts and documentation cannot include a header, is the same
// everywhere.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "core/integrity/failure_state.hpp"
#include "source_tree.hpp"

namespace fail_aware::repeated_facts_test {
namespace {

/// What the pattern's group holds, of each match.
std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match) {
    found.push_back((*match)[1]);
  }
  return found;
}

std::string theOnly(const std::string& file, const std::string& pattern) {
  const std::vector<std::string> found = matches(readText(sourcePath(file)), pattern);
  EXPECT_EQ(found.size(), 1u) << file << ": " << pattern;
  return found.empty() ? "" : found[0];
}

// ---- states ---------------------------------------------------------------------------------------------------------

std::vector<std::string> statesOfTheMessage() {
  std::map<int, std::string> by_number;
  const std::string text = readText(sourcePath("msg/TimeToFailure.msg"));
  const std::regex constant("\nuint8 ([A-Z_]+) = ([0-9]+)");
  for (std::sregex_iterator match(text.begin(), text.end(), constant), end; match != end; ++match) {
    by_number[std::stoi((*match)[2])] = (*match)[1];
  }
  std::vector<std::string> names;
  for (const auto& [number, name] : by_number) {
    EXPECT_EQ(static_cast<std::size_t>(number), names.size()) << name;
    names.push_back(name);
  }
  return names;
}

std::vector<std::string> listOfTheScripts(const std::string& name) {
  return matches(theOnly("scripts/offline_tools/__init__.py", "\n" + name + " = \\[([^\\]]*)\\]"), "\"([A-Z]+)\"");
}

FailAwareState stateCalled(const std::string& name) {
  for (const FailAwareState state : {FailAwareState::kUnknown, FailAwareState::kOk, FailAwareState::kDegraded,
                                     FailAwareState::kFailing, FailAwareState::kFailed}) {
    if (name == toString(state)) return state;
  }
  ADD_FAILURE() << "no state " << name;
  return FailAwareState::kUnknown;
}

TEST(RepeatedFacts, StatesOfMessageCoreAndScripts) {
  const std::vector<std::string> names = statesOfTheMessage();
  ASSERT_EQ(names.size(), 5u);
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(names[i], toString(static_cast<FailAwareState>(i)));
  EXPECT_EQ(listOfTheScripts("STATES"), names);
  const std::vector<std::string> coloured =
      matches(theOnly("scripts/run_report/style.py", "\nSTATE_COLOURS = \\{([^}]*)\\}"), "\"([A-Z]+)\"");
  EXPECT_EQ(coloured, names);
}

/// Worse is taken at once, better not; but UNKNOWN is left at once.
TEST(RepeatedFacts, SeverityOfTheScriptsIsTheHysteresiss) {
  const std::vector<std::string> names = listOfTheScripts("BY_SEVERITY");
  const std::vector<std::string> states = statesOfTheMessage();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()), std::set<std::string>(states.begin(), states.end()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = i + 1; j < names.size(); ++j) {
      const FailAwareState less = stateCalled(names[i]), more = stateCalled(names[j]);
      StateHysteresis rising(2), falling(2);
      rising.update(less);
      EXPECT_EQ(rising.update(more), more) << names[i] << ' ' << names[j];
      falling.update(more);
      EXPECT_EQ(falling.update(less), more == FailAwareState::kUnknown ? less : more) << names[i] << ' ' << names[j];
    }
  }
}

// ---- KITTI's vertical angle -----------------------------------------------------------------------------------------

TEST(RepeatedFacts, VerticalAngleOfKitti) {
  const std::string number = "([0-9]+\\.[0-9]+)";
  const std::string angle = theOnly("launch/kitti_replay.launch", "name=\"vertical_angle_deg\" default=\"" + number);
  const std::multimap<std::string, std::string> places = {
      {"README.md", "sensor\\.vertical_angle\\.angle_deg=" + number},
      {"doc/recorded_data.md", "sensor\\.vertical_angle\\.angle_deg=" + number},
      {"doc/recorded_data.md", "\\| `vertical_angle_deg` \\| " + number},
      {"doc/kitti.md", "sensor\\.vertical_angle\\.angle_deg=" + number},
      {"doc/results.md", "sensor\\.vertical_angle\\.angle_deg=" + number},
      {"cfg/sensors/hdl64e.yaml", "KITTI's scans need " + number},
      {"src/core/preprocessing/angle_corrections.hpp", number + " deg too low"},
      {"src/core/preprocessing/angle_corrections.hpp", "KITTI: " + number},
      {"scripts/benchmark", "sensor\\.vertical_angle\\.angle_deg=" + number},
      {"scripts/benchmark", "beams " + number + " deg too low"},
      {"scripts/replay_benchmark", "\"--vertical-angle\", type=float, default=" + number},
      {"scripts/replay_benchmark", "made-up drives \\(default " + number},
      {"scripts/soak", "\"--vertical-angle\", type=float, default=" + number},
      {"scripts/soak", "made-up drives \\(default " + number},
      {"test/core/preprocessing/angle_corrections_test.cpp", "kKittiAngle_deg = " + number},
      {"test/package/check_launch_files.py", "vertical_angle/angle_deg\"\\] == " + number},
  };
  for (const auto& [file, pattern] : places) {
    const std::vector<std::string> found = matches(readText(sourcePath(file)), pattern);
    EXPECT_FALSE(found.empty()) << file << ": " << pattern;
    for (const std::string& told : found) EXPECT_EQ(told, angle) << file << ": " << pattern;
  }
}

// ---- alert limit ----------------------------------------------------------------------------------------------------

TEST(RepeatedFacts, AlertLimit) {
  const std::string number = "([0-9]+\\.[0-9]+)";
  const std::string limit = theOnly("cfg/profiles/default.yaml", "alert_limit_m: " + number);
  const std::multimap<std::string, std::string> places = {
      {"src/evaluation/time_to_failure.hpp", "alert_limit_m = " + number},
      {"src/core/integrity/covariance_predictor.hpp", "alert_limit_m = " + number},
      {"scripts/fault_matrix", "ALERT_LIMIT_M = " + number},
      {"scripts/run_report/run.py", "alert_limit_m: float = " + number},
  };
  for (const auto& [file, pattern] : places) EXPECT_EQ(theOnly(file, pattern), limit) << file;
}

// ---- topics ---------------------------------------------------------------------------------------------------------

/// Files that may name a topic: what starts, calls, documents and tests the package.
std::vector<std::string> filesWithTopics() {
  std::vector<std::string> files = {"README.md"};
  for (const char* folder : {"launch", "scripts", "src", "include", "cfg", "rviz", "test", "doc", "examples"}) {
    for (const std::string& file : filesBelow(folder)) {
      const bool other = file.find("__pycache__") != std::string::npos || file.rfind("test/fuzz/", 0) == 0;
      if (!other && file != "test/package/repeated_facts_test.cpp") files.push_back(file);
    }
  }
  return files;
}

void expectNoOther(const std::string& pattern, const std::set<std::string>& known,
                   const std::vector<std::string>& places) {
  std::set<std::string> named_in;
  for (const std::string& file : filesWithTopics()) {
    for (const std::string& topic : matches(readText(sourcePath(file)), pattern)) {
      EXPECT_EQ(known.count(topic), 1u) << topic << " in " << file;
      named_in.insert(file);
    }
  }
  for (const std::string& file : places) EXPECT_EQ(named_in.count(file), 1u) << file << " names none";
}

TEST(RepeatedFacts, TopicsOfKittisBags) {
  const std::string writer = "src/bridge/kitti_bag_writer.hpp";
  const std::string cloud = theOnly(writer, "kCloudTopic = \"([^\"]+)\"");
  const std::string ground_truth = theOnly(writer, "kGroundTruthTopic = \"([^\"]+)\"");
  const std::string transforms = theOnly("launch/kitti_replay.launch", "from=\"/tf\" to=\"([^\"]+)\"");
  EXPECT_EQ(theOnly("launch/kitti_replay.launch", "name=\"cloud\" default=\"([^\"]+)\""), cloud);
  EXPECT_EQ(theOnly("scripts/live_graph/__init__.py", "\nCLOUD = \"([^\"]+)\""), cloud);
  expectNoOther("(/kitti/[a-z_/]*[a-z_])", {cloud, ground_truth, transforms},
                {"doc/recorded_data.md", "src/tools/kitti_to_bag.cpp", "scripts/live_graph/__init__.py"});
}

TEST(RepeatedFacts, TopicOfTheVelodynesDriver) {
  const std::string cloud = "/" + theOnly("src/bridge/velodyne_messages.hpp", "cloud_topic = \"([^\"]+)\"");
  for (const char* file : {"launch/odometry.launch", "launch/velodyne_hdl64e.launch"}) {
    EXPECT_EQ(theOnly(file, "name=\"cloud\" default=\"([^\"]+)\""), cloud) << file;
  }
  EXPECT_EQ(theOnly("launch/demo.launch", "name=\"cloud\" value=\"([^\"]+)\""), cloud);
  EXPECT_EQ(theOnly("src/tools/measure_latency.cpp", "cloud = \"([^\"]+)\""), cloud);
  expectNoOther("[\"' `=](/velodyne_p[a-z_]*)", {cloud},
                {"doc/vehicle_setup.md", "src/tools/simulate_drive.cpp", "scripts/check_rviz",
                 "scripts/live_graph/cloud_player.py"});
}

}  // namespace
}  // namespace fail_aware::repeated_facts_test
