#include "core/io/profile_files.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <filesystem>

#include "core/io/input_error.hpp"
#include "core/parameters/validate.hpp"
#include "core/parameters/yaml_parameters.hpp"

namespace fail_aware {

namespace {

namespace fs = std::filesystem;

bool isPath(const std::string& name) {
  return name.find('/') != std::string::npos || fs::path(name).extension() == ".yaml";
}

constexpr const char* kDefault = "default";
constexpr const char* kExpert = "expert";  // in the profiles' folder, but a layer below each profile and not a profile

std::string resolve(const fs::path& folder, const std::string& name, const std::string& what) {
  const fs::path file = isPath(name) ? fs::path(name) : folder / (name + ".yaml");
  std::error_code error;  // an invalid file name counts as a missing file
  if (fs::is_regular_file(file, error)) return file.string();
  if (isPath(name)) throw InputError(name + ": no such file");
  std::vector<std::string> known;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".yaml") known.push_back(entry.path().stem().string());
  }
  known.erase(std::remove(known.begin(), known.end(), kExpert), known.end());
  std::sort(known.begin(), known.end());
  std::string list;
  for (const std::string& stem : known) list += (list.empty() ? "" : ", ") + stem;
  throw InputError("no " + what + " " + name + "; there are: " + list + "; or give the path of a yaml file");
}

template <class Struct>
bool isFileOf(const ParameterMap& values) {
  Struct parameters;
  try {
    fromMap(parameters, values);
  } catch (const ParameterError&) {
    return false;
  }
  return true;
}

/// loadYaml(); a file of another kind than `kind` is named as that.
template <class Struct>
void load(const YamlParameters& file, const std::string& kind, Struct& parameters, MissingKeys missing_keys) {
  try {
    fromMap(parameters, file.values, missing_keys);
  } catch (const ParameterKeyError& error) {
    const std::string is = kindOf(file.values);
    if (is.empty() || is == kind) throw located(file, error);
    throw InputError(file.source + ": is the file of a " + is + ": give it as " + is + ", not as " + kind);
  }
}

bool isCfg(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder / "profiles", error);
}

}  // namespace

std::string kindOf(const ParameterMap& values) {
  if (isFileOf<SensorParameters>(values)) return "sensor";
  return isFileOf<VehicleFileParameters>(values) ? "vehicle" : "";
}

std::string findCfg() {
  // Installed: PREFIX/lib/libNAME.so (or what contains the code: a program PREFIX/lib/PACKAGE/NAME, the Python module
  // PREFIX/lib/python3/dist-packages/NAME.so) with PREFIX/share/PACKAGE/cfg. Of a program in PATH dladdr knows the name
  // only.
  Dl_info here{};
  dladdr(reinterpret_cast<const void*>(&findCfg), &here);
  std::error_code error;
  for (const std::string code : {here.dli_fname == nullptr ? "" : here.dli_fname, "/proc/self/exe"}) {
    fs::path folder = fs::canonical(code, error).parent_path();
    for (int levels = 0; levels < 3; ++levels) {
      folder = folder.parent_path();
      const fs::path installed = folder / "share" / "fail_aware_lidar_odometry" / "cfg";
      if (isCfg(installed)) return installed.string();
    }
  }
  if (isCfg(FAIL_AWARE_SOURCE_CFG)) return FAIL_AWARE_SOURCE_CFG;
  throw InputError("the package's cfg folder was not found; give it with --cfg");
}

PipelineParameters loadPipelineParameters(const ProfileFiles& files) {
  const fs::path cfg = files.cfg.empty() ? findCfg() : files.cfg;
  if (!isCfg(cfg)) throw InputError("no cfg folder: " + cfg.string() + " has no profiles/");
  PipelineParameters params;
  for (const std::string& layer : {std::string(kDefault), std::string(kExpert), files.profile}) {
    load(readYaml(resolve(cfg / "profiles", layer, "profile")), "profile", params.profile, MissingKeys::kKeep);
  }
  load(readYaml(resolve(cfg / "vehicles", files.vehicle, "vehicle")), "vehicle", params.vehicle, MissingKeys::kRefuse);
  load(readYaml(resolve(cfg / "sensors", files.sensor, "sensor")), "sensor", params.sensor, MissingKeys::kRefuse);
  validate(params);
  return params;
}

void overrideParameters(PipelineParameters& params, const std::vector<std::string>& files,
                        const std::vector<std::string>& assignments) {
  for (const std::string& path : files) {
    const YamlParameters file = readYaml(path);  // once: it may be a pipe
    if (file.values.empty()) throw ParameterError(path + ": has no parameters; write some, or leave the file out");
    load(file, "parameters", params, MissingKeys::kKeep);
  }
  for (const std::string& assignment : assignments) setParameter(params, assignment);
  validate(params);
}

}  // namespace fail_aware
