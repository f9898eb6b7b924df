// scripts/install_dependencies with stand-ins for apt, --cli11 of the scripts that hand it on, and test_in_chroot's
// usage.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "../support/tool_run.hpp"
#include "source_tree.hpp"

namespace fail_aware::install_dependencies_test {
namespace {

namespace fs = std::filesystem;

class InstallDependencies : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(programs_);
    fs::create_directories(folder_ / "cli11" / "CLI");
    std::ofstream(folder_ / "cli11" / "CLI" / "CLI.hpp") << '\n';
    standIn("id", "echo 0");
    standIn("getent", "exit 0");
    standIn("apt-get", "echo \"apt-get $*\"");
    standIn("dpkg-query",
            "for name; do case $name in -*|'$'*|libcli11-dev) ;; *) echo \"$name installed\";; esac; done");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void standIn(const std::string& name, const std::string& script) const {
    const fs::path path = programs_ / name;
    std::ofstream(path) << "#!/bin/sh\n" << script << '\n';
    fs::permissions(path, fs::perms::owner_all);
  }

  /// What apt's lists know: without a package's name the repositories, with it the package's candidate.
  void listsKnow(const std::string& candidate, const std::string& repository = "release o=Debian,c=main") const {
    standIn("apt-cache",
            "if [ $# -gt 1 ]; then echo '  Candidate: " + candidate + "'; else echo ' " + repository + "'; fi");
  }

  ToolRun run(const std::string& script, const std::string& arguments) const {
    return runProgram(sourcePath("scripts/" + script), arguments, folder_, "PATH='" + programs_.string() + "':$PATH");
  }

  bool isOnUbuntu() const { return fs::exists("/opt/ros/noetic/setup.bash"); }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("install_dependencies_" + std::to_string(getpid()));
  const fs::path programs_ = folder_ / "programs";
};

TEST_F(InstallDependencies, CLI11IsInstalledWhereThereIsAPackage) {
  if (isOnUbuntu()) GTEST_SKIP() << "rosdep's business";
  listsKnow("2.1.2");
  const ToolRun found = run("install_dependencies", "");
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_NE(found.out.find("apt-get -o DPkg::Lock::Timeout=600 install -y --no-install-recommends libcli11-dev\n"),
            std::string::npos)
      << found.out;
}

TEST_F(InstallDependencies, MissingCli11IsReported) {
  if (isOnUbuntu()) GTEST_SKIP() << "rosdep's business";
  standIn("dpkg-query", "exit 1");
  listsKnow("(none)");
  const ToolRun found = run("install_dependencies", "");
  EXPECT_EQ(found.exit_code, 0) << found.err;
  const std::size_t install = found.out.find("apt-get -o DPkg::Lock::Timeout=600 install");
  ASSERT_NE(install, std::string::npos) << found.out;
  EXPECT_NE(found.out.find(" libeigen3-dev", install), std::string::npos) << found.out;
  EXPECT_EQ(found.out.find(" libcli11-dev ", install), std::string::npos) << found.out;
  if (fs::exists("/usr/include/CLI/CLI.hpp") || fs::exists("/usr/local/include/CLI/CLI.hpp")) return;  // nothing is
  EXPECT_EQ(countOf(found.out, "no package libcli11-dev here: the tools"), 1u) << found.out;
}

TEST_F(InstallDependencies, AnEmptyListOfAptLeavesNothingOut) {
  if (isOnUbuntu()) GTEST_SKIP() << "rosdep's business";
  listsKnow("(none)", "release a=now");
  const ToolRun found = run("install_dependencies", "");
  EXPECT_NE(found.out.find(" libcli11-dev\n"), std::string::npos) << found.out;
}

TEST_F(InstallDependencies, AFolderWithItsHeadersStandsForCLI11) {
  if (isOnUbuntu()) GTEST_SKIP() << "rosdep's business";
  listsKnow("2.1.2");
  const ToolRun found = run("install_dependencies", "--cli11 '" + (folder_ / "cli11").string() + "'");
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_EQ(found.out, "");
}

TEST_F(InstallDependencies, FolderWithoutHeadersIsRefused) {
  for (const std::string script : {"install_dependencies", "build", "test"}) {
    for (const std::string& arguments : {"--cli11 '" + programs_.string() + "'", std::string("--cli11")}) {
      const ToolRun refused = run(script, arguments);
      EXPECT_EQ(refused.exit_code, 2) << script << ' ' << arguments;
      expectOneErrorLine(refused, script, "--cli11 needs a folder that holds CLI/CLI.hpp");
    }
  }
}

TEST_F(InstallDependencies, AChrootNeedsASuite) {
  for (const std::string arguments :
       {"", "--mirror", "--no-such-option bullseye", "bullseye bookworm", "bullseye --"}) {
    const ToolRun refused = run("test_in_chroot", arguments);
    EXPECT_EQ(refused.exit_code, 2) << arguments;
    expectOneErrorLine(refused, "test_in_chroot");
  }
  EXPECT_NE(run("test_in_chroot", "--help").out.find("--mirror URL"), std::string::npos);
}

}  // namespace
}  // namespace fail_aware::install_dependencies_test
