// Runs scripts/live_demo: the live graph on a made-up drive, on a ROS master of its own. SCRIPTS is its folder,
// DRIVE_SIMULATOR that of its node (compile definitions); the workspace's setup.bash must be sourced, as it is under
// ctest in a catkin workspace.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "../support/tool_run.hpp"

namespace fail_aware::live_demo_test {
namespace {

namespace fs = std::filesystem;

/// Processes whose environment or arguments name this folder, but for this one.
std::vector<std::string> processesOf(const fs::path& folder) {
  std::vector<std::string> found;
  for (const fs::directory_entry& entry : fs::directory_iterator("/proc")) {
    const std::string pid = entry.path().filename().string();
    if (!std::all_of(pid.begin(), pid.end(), [](char c) { return c >= '0' && c <= '9'; })) continue;
    if (std::stol(pid) == getpid()) continue;
    std::string command = contentOf(entry.path() / "cmdline");
    std::replace(command.begin(), command.end(), '\0', ' ');
    const std::string known = command + contentOf(entry.path() / "environ");
    if (known.find(folder.string()) != std::string::npos) found.push_back(pid + " " + command);
  }
  return found;
}

class LiveDemo : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = fs::path(::testing::TempDir()) / ("live_demo_" + std::to_string(getpid()) + "_" + name);
    fs::create_directories(folder_);
  }
  void TearDown() override {
    EXPECT_TRUE(processesOf(folder_ / "out").empty()) << processesOf(folder_ / "out").front();
    if (!HasFailure()) fs::remove_all(folder_);
  }

  /// Arguments without blanks.
  void start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), SCRIPTS "/live_demo");
    pid_ = fork();
    ASSERT_GE(pid_, 0);
    if (pid_ != 0) return;
    redirect(STDOUT_FILENO, "stdout");
    redirect(STDERR_FILENO, "stderr");
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    execv(pointers[0], pointers.data());
    _exit(127);
  }
  int wait() const {
    int status = 0;
    waitpid(pid_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  bool ended() const {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == pid_;
  }
  std::string out() const { return contentOf(folder_ / "stdout"); }
  std::string err() const { return contentOf(folder_ / "stderr"); }
  std::string output() const { return (folder_ / "out").string(); }

  fs::path folder_;
  pid_t pid_ = -1;

 private:
  void redirect(int descriptor, const char* name) const {
    const int file = open((folder_ / name).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (file < 0 || dup2(file, descriptor) < 0) _exit(126);
  }
};

TEST_F(LiveDemo, DrivesRecordsAndReports) {
  start({"--duration", "6", "--seed", "2", "--output", output()});
  ASSERT_EQ(wait(), 0) << err() << out();
  EXPECT_EQ(err(), "");
  EXPECT_NE(out().find("GPS lost"), std::string::npos) << out();
  EXPECT_NE(out().find("error at the end, since t1"), std::string::npos) << out();
  EXPECT_GT(fs::file_size(folder_ / "out/drive.bag"), 10000u);
  EXPECT_GT(countOf(contentOf(folder_ / "out/trajectory_tum.txt"), "\n"), 20u);
  const std::string page = contentOf(folder_ / "out/report.html");
  EXPECT_EQ(countOf(page, "data:image/png;base64,"), 9u);
  EXPECT_EQ(page.find("No picture"), std::string::npos);
}

TEST_F(LiveDemo, StopsInOrderWhenInterrupted) {
  start({"--duration", "600", "--output", output()});
  while (out().find(" s  ") == std::string::npos && !ended()) usleep(100000);  // it drives
  ASSERT_FALSE(ended()) << err() << out();
  EXPECT_FALSE(processesOf(folder_ / "out").empty());
  kill(pid_, SIGINT);
  EXPECT_EQ(wait(), 130) << err();
  EXPECT_EQ(err(), "live_demo: stopped\n");
}

TEST_F(LiveDemo, SaysInOneLineWhatIsWrong) {
  start({"--duration", "1"});
  EXPECT_EQ(wait(), 2);
  std::ofstream(folder_ / "file") << "";
  start({"--output", (folder_ / "file").string()});
  EXPECT_EQ(wait(), 1);
  EXPECT_EQ(err().rfind("live_demo: error: cannot write in ", 0), 0u) << err();
  EXPECT_EQ(countOf(err(), "\n"), 1u) << err();
}

TEST_F(LiveDemo, TheSimulatorSaysWhatItTakes) {
  const std::string no_master = "ROS_MASTER_URI=http://localhost:1";
  const ToolRun help = runProgram(DRIVE_SIMULATOR, "--help", folder_, no_master);
  EXPECT_EQ(help.exit_code, 0) << help.err;
  EXPECT_NE(help.out.find("\nduration_s: 60.0\n"), std::string::npos) << help.out;
  const ToolRun unknown = runProgram(DRIVE_SIMULATOR, "__name:=car _seed:=3 --seed 3", folder_, no_master);
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_EQ(unknown.err, "drive_simulator: error: unknown argument --seed (see --help)\n");
}

}  // namespace
}  // namespace fail_aware::live_demo_test
