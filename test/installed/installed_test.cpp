// The package as others use it: a CMake project and a Python script over the devel space, the install space and a build
// without ROS; a catkin package over the devel space.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "../support/room_drive.hpp"
#include "../support/tool_run.hpp"
#include "fail_aware_lidar_odometry/odometry.hpp"

namespace fail_aware::installed_test {
namespace {

namespace fs = std::filesystem;

const fs::path kSource = FAIL_AWARE_SOURCE_DIR;
/// Nothing of a workspace that is sourced where the test runs.
const std::string kStranger =
    "env -u CMAKE_PREFIX_PATH -u PYTHONPATH -u ROS_PACKAGE_PATH -u LD_LIBRARY_PATH PATH=\"/usr/bin:$PATH\"";
const fs::path kPython = fs::path("lib/python3/dist-packages");

class Installed : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    fs::create_directories(folder());
    writeRoomDrive(folder() / "drive");
    minimal_ = runProgram(MINIMAL_EXAMPLE, drive(), folder());
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }

  static fs::path folder() { return fs::path(testing::TempDir()) / ("installed_" + std::to_string(getpid())); }
  static std::string drive() { return "'" + (folder() / "drive").string() + "'"; }
  static std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

  static void expectDone(const std::string& program, const std::string& arguments,
                         const std::string& environment = kStranger) {
    const ToolRun run = runProgram(program, arguments, folder(), environment);
    ASSERT_EQ(run.exit_code, 0) << program << ' ' << arguments << '\n' << run.out << run.err;
  }

  /// examples/minimal_project, built against `prefix`, and examples/minimal.py print what the package's own build
  /// prints.
  static void expectMinimalOver(const fs::path& prefix, const fs::path& examples, const std::string& name) {
    const fs::path build = folder() / name;
    expectDone(CMAKE, "-S " + quoted(examples / "minimal_project") + " -B " + quoted(build) +
                          " -DCMAKE_PREFIX_PATH=" + quoted(prefix));
    expectDone(CMAKE, "--build " + quoted(build));
    if (HasFatalFailure()) return;
    const ToolRun cpp = runProgram((build / "minimal").string(), drive(), folder(), kStranger);
    EXPECT_EQ(cpp.exit_code, 0) << cpp.err;
    EXPECT_EQ(cpp.out, minimal_.out);
#ifdef PYTHON_MODULE_DIR
    const ToolRun python = runProgram((examples / "minimal.py").string(), drive(), folder(),
                                      kStranger + " PYTHONPATH=" + quoted(prefix / kPython));
    EXPECT_EQ(python.exit_code, 0) << python.err;
    EXPECT_EQ(python.out, minimal_.out);
#endif
  }

  static ToolRun minimal_;
};

ToolRun Installed::minimal_;

TEST_F(Installed, MinimalExampleRunsOverAFolder) {
  EXPECT_EQ(minimal_.exit_code, 0) << minimal_.err;
  EXPECT_EQ(std::count(minimal_.out.begin(), minimal_.out.end(), '\n'), kRoomSweeps) << minimal_.out;
  std::smatch last;
  ASSERT_TRUE(std::regex_search(minimal_.out, last, std::regex("0\\.400 s  x ([0-9.]+) .*  OK  [0-9.]+ s\n$")))
      << minimal_.out;
  EXPECT_NEAR(std::stod(last[1]), 2.0, 0.1);
  EXPECT_EQ(runProgram(MINIMAL_EXAMPLE, "", folder()).exit_code, 2);
  const ToolRun without_scans = runProgram(MINIMAL_EXAMPLE, "/no/such/folder", folder());
  EXPECT_EQ(without_scans.exit_code, 1);
  EXPECT_EQ(without_scans.err, "minimal: error: no scans in /no/such/folder/velodyne\n");
}

/// Configures a build without ROS, tests and simulator.
std::string plainBuild(const fs::path& build) {
  return "-S '" + kSource.string() + "' -B '" + build.string() +
         "' -DFAIL_AWARE_WITH_CATKIN=OFF -DFAIL_AWARE_BUILD_TESTS=OFF -DFAIL_AWARE_WITH_SIMULATION=OFF";
}

/// Compiler, definitions, folders and flags of a target, without what catkin adds.
std::vector<std::string> compilationOf(const fs::path& target) {
  std::vector<std::string> words;
  std::ifstream file(target / "flags.make");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("# compile CXX with ", 0) != 0 && line.rfind("CXX_", 0) != 0) continue;
    std::istringstream stream(line);
    for (std::string word; stream >> word;) {
      if (word.rfind("-DROS", 0) != 0 && word.find("/devel/include") == std::string::npos) words.push_back(word);
    }
  }
  return words;
}

/// Copies what this build has compiled of a target to a build that would compile the same sources in the same way once
/// more: only ROS's headers could make a difference, and none is included. With another compiler or other flags it copies
/// nothing.
void lendObjects(const fs::path& build, const std::string& folder, const std::string& name) {
  const fs::path place = fs::path("src") / folder / "CMakeFiles" / ("fail_aware_lidar_odometry_" + name + ".dir");
  const fs::path ours = fs::path(BUILD_DIR) / place, theirs = build / place;
  const std::vector<std::string> compilation = compilationOf(ours);
  if (compilation.empty() || compilation != compilationOf(theirs)) return;
  for (const char* kind : {".gch", ".o"}) {  // an object must not be older than the precompiled header
    for (const auto& entry : fs::recursive_directory_iterator(ours)) {
      const fs::path object = entry.path(), copy = theirs / fs::relative(object, ours);
      if (object.extension() != kind) continue;
      const std::string headers = contentOf(object.string() + ".d");
      EXPECT_NE(headers, "") << object;
      for (const char* of_ros : {"/include/ros/", "_msgs/", "/devel/include/"}) {
        EXPECT_EQ(headers.find(of_ros), std::string::npos) << object << " needs " << of_ros;
      }
      if (contentOf(fs::path(object).replace_extension()) != contentOf(fs::path(copy).replace_extension())) continue;
      fs::create_directories(copy.parent_path());
      fs::copy_file(object, copy);
    }
  }
}

TEST_F(Installed, BuildWithoutRosServesAStrangersProject) {
  const fs::path build = folder() / "plain", prefix = folder() / "plain_prefix";
  expectDone(CMAKE,
             plainBuild(build) + " -DCMAKE_INSTALL_PREFIX=" + quoted(prefix) + " -DCLI11_INCLUDE_DIR=OFF");  // no tools
  if (HasFatalFailure()) return;
  lendObjects(build, "core", "core");
#ifdef PYTHON_MODULE_DIR
  lendObjects(build, "python", "python");
#endif
  expectDone(CMAKE, "--build " + quoted(build) + " -j 2");
  expectDone(CMAKE, "--install " + quoted(build));
  if (HasFatalFailure()) return;
  fs::remove_all(build);
  expectMinimalOver(prefix, prefix / "share/fail_aware_lidar_odometry/examples", "plain_minimal");
}

TEST_F(Installed, ToolsCompileWithoutRos) {
  const fs::path build = folder() / "plain_tools";
  expectDone(CMAKE, plainBuild(build));
  if (!fs::exists(build / "src/tools")) GTEST_SKIP() << "no CLI11 here";
  // the sources that differ without ROS
  expectDone("make", "-C " + quoted(build / "src/tools") + " -j 2 offline_odometry.o tool_support.o");
  fs::remove_all(build);
}

#ifdef DEVEL_DIR
TEST_F(Installed, DevelSpaceServesAStrangersProject) {
  expectMinimalOver(DEVEL_DIR, kSource / "examples", "devel_minimal");
}

TEST_F(Installed, InstallSpaceServesAStrangersProject) {
  if (!fs::exists(fs::path(DEVEL_DIR) / "lib/libfail_aware_lidar_odometry_nodelets.so"))
    GTEST_SKIP() << "build all first";
  const fs::path prefix = folder() / "install";
  expectDone(CMAKE,
             "-DCMAKE_INSTALL_PREFIX=" + quoted(prefix) + " -P " + quoted(fs::path(BUILD_DIR) / "cmake_install.cmake"));
  if (HasFatalFailure()) return;
  expectMinimalOver(prefix, prefix / "share/fail_aware_lidar_odometry/examples", "install_minimal");
  fs::remove_all(prefix);
}

TEST_F(Installed, PackageWithASourceJoinsTheFusion) {
  const fs::path workspace = folder() / "workspace";
  fs::create_directories(workspace / "src");
  fs::copy(kSource / "examples/add_a_source", workspace / "src/add_a_source", fs::copy_options::recursive);
  const auto sourced = [](const fs::path& space, const std::string& command) {
    return "-c 'source \"" + (space / "setup.bash").string() + "\" && " + command + "'";
  };
  expectDone("/bin/bash", sourced(DEVEL_DIR, "catkin_make -C \"" + workspace.string() + "\""));
  if (HasFatalFailure()) return;
  const fs::path launch = kSource / "test/installed/add_a_source.launch";
  expectDone("/bin/bash", sourced(workspace / "devel", "rostest --text \"" + launch.string() + "\""),
             kStranger + " ROS_HOSTNAME=localhost ROS_TEST_RESULTS_DIR=" + quoted(folder() / "results"));
}
#endif

#ifdef PYTHON_MODULE_DIR
class Python : public Installed {
 protected:
  ToolRun python(const std::string& script) const {
    const fs::path file = folder() / "script.py";
    std::ofstream(file) << "import pathlib, sys, numpy, fail_aware\n" << script;
    return runProgram("/usr/bin/python3", quoted(file) + " " + drive(), folder(),
                      kStranger + " PYTHONPATH='" PYTHON_MODULE_DIR "'");
  }
};

/// Numbers as hexadecimal floats: the same bits as in C++.
TEST_F(Python, GivesTheSameBits) {
  const ToolRun run = python(R"(
odometry = fail_aware.Odometry(parameters={"registration.use_corner_svd": False, "sensor.lidar_in_base": (0.1, 0, 1.7, 0, 0, 0)})
odometry.start_redundant()
for i, path in enumerate(sorted(pathlib.Path(sys.argv[1], "velodyne").iterdir())):
    points = numpy.fromfile(path, dtype=numpy.float32).reshape(-1, 4)[:, :3]
    points = (points, points.astype(numpy.float64), numpy.asfortranarray(points), numpy.ascontiguousarray(points))[i % 4]
    result = odometry.step(points, 0.1 * i, rings=numpy.repeat(numpy.arange(32), 360))
    numbers = numpy.concatenate([result.pose.ravel(), result.covariance.ravel(), [result.time_to_failure]])
    print(" ".join(float(x).hex() for x in numbers), result.state, "|".join(result.reasons))
)");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  Parameters parameters;
  parameters.overrides = {{"registration.use_corner_svd", "false"}, {"sensor.lidar_in_base", "[0.1, 0, 1.7, 0, 0, 0]"}};
  Odometry odometry(parameters);
  odometry.startRedundant();
  std::istringstream lines(run.out);
  for (int i = 0; i < kRoomSweeps; ++i) {
    Sweep sweep;
    sweep.stamp_s = 0.1 * i;
    std::ifstream file(folder() / "drive/velodyne" / ("00000" + std::to_string(i) + ".bin"), std::ios::binary);
    for (float p[4]; file.read(reinterpret_cast<char*>(p), sizeof p);) {
      sweep.rings.push_back(static_cast<std::uint16_t>(sweep.points_lidar.size() / 360));
      sweep.points_lidar.emplace_back(p[0], p[1], p[2]);
    }
    const Result result = odometry.step(sweep);
    std::string line, word;
    ASSERT_TRUE(std::getline(lines, line));
    std::istringstream words(line);
    const auto expectNext = [&](double expected) {
      ASSERT_TRUE(words >> word);
      EXPECT_EQ(std::strtod(word.c_str(), nullptr), expected) << "sweep " << i;
    };
    for (int k = 0; k < 16; ++k) expectNext(result.T_odom_base.matrix()(k / 4, k % 4));
    for (int k = 0; k < 36; ++k) expectNext(result.covariance(k / 6, k % 6));
    expectNext(result.monitor.time_to_failure.seconds);
    std::string rest;
    std::getline(words, rest);
    EXPECT_EQ(rest, std::string(" ") + toString(result.monitor.state) + ' ' + reasonText(result.monitor.reasons));
  }
}

TEST_F(Python, TimesOfAClockKeepTheirResolution) {
  const ToolRun run = python(R"(
azimuth = numpy.tile(numpy.linspace(numpy.pi, -numpy.pi, 900, endpoint=False), 16)
times = numpy.tile(numpy.linspace(0.0, 0.1, 900, endpoint=False), 16)
height = numpy.repeat(numpy.linspace(-1.5, 3.0, 16), 900)
def sweep(start_x):  # in a room of 30 m by 16 m, at 5 m/s
    x = start_x + 5.0 * times
    c, s = numpy.cos(azimuth), numpy.sin(azimuth)
    r = numpy.minimum(numpy.where(c > 0, 15.0 - x, 15.0 + x) / numpy.maximum(abs(c), 1e-9),
                      8.0 / numpy.maximum(abs(s), 1e-9))
    return numpy.stack([r * c, r * s, height], 1)
def final_x(of_a_clock):
    odometry = fail_aware.Odometry()
    for i in range(3):
        point_times = times + (1.6e9 + 0.1 * i if of_a_clock else 0.0)
        result = odometry.step(sweep(-5.0 + 0.5 * i), 1.6e9 + 0.1 * i, point_times=point_times)
    return result.pose[0, 3]
assert abs(final_x(False) - 1.0) < 0.01
assert abs(final_x(True) - final_x(False)) < 2e-6, "without times it is 8e-4"
)");
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
}

TEST_F(Python, RefusesWhatMakesNoSenseWithAValueError) {
  const ToolRun run = python(R"(
odometry = fail_aware.Odometry()
good = numpy.ones((4, 3))
def refused(part, call, *arguments, **named):
    try:
        call(*arguments, **named)
    except ValueError as error:
        assert part in str(error) and "\n" not in str(error), error
        return
    raise AssertionError(part)
refused("points_xyz", odometry.step, numpy.ones((3, 4)), 0.0)
refused("points_xyz", odometry.step, numpy.ones(3), 0.0)
refused("points_xyz", odometry.step, "points", 0.0)
refused("points_xyz", odometry.step, numpy.full((4, 3), "a"), 0.0)
refused("points_xyz", odometry.step, [[1, 2, 3], [1, 2]], 0.0)
refused("stamp", odometry.step, good, float("nan"))
refused("point_times", odometry.step, good, 0.0, numpy.zeros(3))
refused("rings", odometry.step, good, 0.0, rings=[0, 1, 2, -1])
refused("rings", odometry.step, good, 0.0, rings=[0, 1, 2, 0.5])
refused("pose", odometry.set_pose, numpy.eye(3))
refused("pose", odometry.set_pose, 2 * numpy.eye(4))
refused("covariance", odometry.set_pose, numpy.eye(4), covariance=numpy.full((6, 6), float("inf")))
refused("no.such.key", fail_aware.Odometry, parameters={"no.such.key": 1})
try:
    fail_aware.Odometry(profile="no_such_profile")
except RuntimeError as error:
    assert "no_such_profile" in str(error)
refused("from_stamp", odometry.start_redundant, float("nan"))
nothing = odometry.step(numpy.full((4, 3), float("nan")), 0.0)
assert nothing.status == "not_started" and not nothing.has_pose and nothing.t1 is None
assert nothing.pose.shape == (4, 4) and nothing.covariance.shape == (6, 6) and nothing.state == "UNKNOWN"
odometry.step(good.tolist(), 0.1, point_times=[0.0, 0.1, 0.2, 0.3])
odometry.set_pose(numpy.eye(4))
odometry.reset()
assert fail_aware.__version__.count(".") == 2
for name in ("step", "set_pose", "start_redundant", "stop_redundant"):
    assert getattr(fail_aware.Odometry, name).__doc__
)");
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
}
#endif

}  // namespace
}  // namespace fail_aware::installed_test
