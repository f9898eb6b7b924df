#include "plot_script.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <vector>

extern char** environ;

namespace fail_aware {

namespace {

namespace fs = std::filesystem;

fs::path findScript(const std::string& name) {
  std::vector<fs::path> folders;
  if (const char* folder = std::getenv("FAIL_AWARE_SCRIPTS_DIR")) {
    folders.emplace_back(folder);
  } else {
    std::error_code ignored;
    folders.push_back(fs::read_symlink("/proc/self/exe", ignored).parent_path());
#ifdef FAIL_AWARE_SCRIPTS_DIR
    folders.emplace_back(FAIL_AWARE_SCRIPTS_DIR);
#endif
  }
  for (const fs::path& folder : folders) {
    fs::path script = folder / name;
    if (access(script.c_str(), X_OK) == 0) return script;
  }
  return {};
}

}  // namespace

void runPlotScript(const std::string& tool, const std::string& script_name, const fs::path& folder) {
  const std::string script = findScript(script_name).string();
  if (script.empty()) {
    std::cerr << tool << ": no plots: " << script_name << " was not found\n";
    return;
  }
  std::string argument = folder.string();
  std::string program = script;
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);  // stdout is for the JSON
  pid_t child = 0;
  const int refused = posix_spawn(&child, script.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (refused != 0) {
    std::cerr << tool << ": no plots: " << script << ": " << std::strerror(refused) << '\n';
    return;
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const bool already_said = WIFEXITED(status) && WEXITSTATUS(status) == 3;
  if (status != 0 && !already_said) std::cerr << tool << ": no plots: " << script << " failed\n";
}

}  // namespace fail_aware
