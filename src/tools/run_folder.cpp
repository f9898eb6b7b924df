#include "run_folder.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <random>
#include <stdexcept>
#include <utility>

#include "core/io/input_error.hpp"
#include "crc32.hpp"
#include "result_files.hpp"

namespace fail_aware {

namespace {

namespace fs = std::filesystem;

constexpr const char* kSummary = "summary.json";
const std::string kUnfinished = "unfinished_";
constexpr std::size_t kIdDigits = 16;

/// Begins with a letter that is not a hexadecimal digit, so that nobody mistakes it for a number.
std::string newId() {
  std::random_device random;
  char text[kIdDigits + 2];
  std::snprintf(text, sizeof(text), "r%08x%08x", random(), random());
  return text;
}

/// The id of a folder that an unfinished run left; empty: the folder is something else.
std::string idOfUnfinished(const fs::path& path) {
  const std::string name = path.filename().string();
  if (name.rfind(kUnfinished + "r", 0) != 0 || name.size() != kUnfinished.size() + 1 + kIdDigits) return {};
  const std::string digits = name.substr(kUnfinished.size() + 1);
  const auto is_digit = [](unsigned char c) { return std::isxdigit(c) != 0; };
  return std::all_of(digits.begin(), digits.end(), is_digit) ? name.substr(kUnfinished.size()) : std::string();
}

std::vector<fs::path> unfinishedIn(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (!idOfUnfinished(it->path()).empty() && it->is_directory(error)) found.push_back(it->path());
  }
  return found;
}

struct FileMark {
  std::uint64_t bytes = 0;
  std::uint32_t crc32 = 0;
};

/// False if the file cannot be read.
bool markOf(const fs::path& path, FileMark& mark) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  std::ifstream file(path, std::ios::binary);
  if (!file) return false;
  mark = {};
  Crc32 crc;
  std::array<char, 65536> block{};
  do {
    file.read(block.data(), block.size());
    const auto count = static_cast<std::size_t>(file.gcount());
    crc.add(block.data(), count);
    mark.bytes += count;
  } while (file);
  mark.crc32 = crc.value();
  return !file.bad();
}

constexpr const char* kRunAgain = "; run offline_odometry again";

std::size_t wholeNumber(const Json& summary, const char* pointer, const fs::path& path) {
  const Json::json_pointer at(pointer);
  if (!summary.contains(at) || !summary.at(at).is_number_unsigned()) {
    throw InputError(path.string() + ": no number of scans at " + pointer + kRunAgain);
  }
  return summary.at(at).get<std::size_t>();
}

}  // namespace

RunFolder::RunFolder(const fs::path& folder, std::vector<std::string> files)
    : folder_(folder), files_(std::move(files)), id_(newId()) {
  makeResultFolder(folder_);
  if (!fs::is_directory(folder_)) throw InputError(folder_.string() + ": is not a folder");
  std::error_code error;
  for (const std::string& name : files_) {
    if (fs::is_directory(folder_ / name, error)) throw InputError("cannot write " + (folder_ / name).string());
  }
  if (fs::is_directory(folder_ / kSummary, error)) throw InputError("cannot write " + (folder_ / kSummary).string());
  unfinished_ = folder_ / (kUnfinished + id_);
  if (!fs::create_directory(unfinished_, error))
    throw InputError("cannot write in the output folder " + folder_.string());
  for (const fs::path& left : unfinishedIn(folder_)) {
    if (left != unfinished_) fs::remove_all(left, error);
  }
}

Json RunFolder::finish(Json summary) {
  sealRun(unfinished_, files_, id_, summary);
  std::error_code error;
  fs::remove(folder_ / kSummary, error);  // from here to the end the folder contains no valid run
  std::vector<std::string> names = files_;
  names.emplace_back(kSummary);
  for (const std::string& name : names) {
    fs::rename(unfinished_ / name, folder_ / name, error);
    if (error) throw std::runtime_error("cannot write " + (folder_ / name).string() + ": " + error.message());
  }
  fs::remove_all(unfinished_, error);
  if (error) throw std::runtime_error("cannot remove " + unfinished_.string() + ": " + error.message());
  return summary;
}

void sealRun(const fs::path& folder, const std::vector<std::string>& files, const std::string& id, Json& summary) {
  summary["run"]["id"] = id;
  Json marks = Json::object();
  for (const std::string& name : files) {
    FileMark mark;
    if (!markOf(folder / name, mark)) throw std::runtime_error((folder / name).string() + ": cannot be read back");
    marks[name] = {{"bytes", mark.bytes}, {"crc32", mark.crc32}};
  }
  summary["files"] = marks;
  // file names may not be UTF-8
  writeText(folder / kSummary, summary.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

Json readRunSummary(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw InputError(folder.string() + ": no such folder");
  const fs::path path = folder / kSummary;
  const bool has_summary = fs::exists(path, error);
  if (const std::vector<fs::path> left = unfinishedIn(folder); !left.empty()) {
    throw InputError(left.front().string() + ": a run in this folder did not finish, or is not done yet" + kRunAgain +
                     (has_summary ? ", or delete that folder to use the results of the run before it" : ""));
  }
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be read: not the folder of a finished run" + kRunAgain);
  Json summary = Json::parse(file, nullptr, false);
  if (!summary.is_object()) throw InputError(path.string() + ": cannot be read as JSON" + kRunAgain);
  const Json::json_pointer id_at("/run/id"), files_at("/files");
  if (!summary.contains(id_at) || !summary.at(id_at).is_string() || !summary.contains(files_at) ||
      !summary.at(files_at).is_object()) {
    throw InputError(path.string() +
                     ": names no run (run.id, files): a version that did not check its results wrote it, and "
                     "its files may be those of several runs" +
                     kRunAgain);
  }
  const auto id = summary.at(id_at).get<std::string>();
  for (const auto& item : summary.at(files_at).items()) {
    const std::string name = (folder / item.key()).string();
    FileMark mark;
    if (!fs::exists(name, error)) throw InputError(name + ": missing; run " + id + " wrote it" + kRunAgain);
    if (!markOf(name, mark)) throw InputError(name + ": cannot be read");
    if (item.value() != Json({{"bytes", mark.bytes}, {"crc32", mark.crc32}})) {
      throw InputError(name + ": not the file that run " + id + " of summary.json wrote: another run's, or changed" +
                       kRunAgain);
    }
  }
  return summary;
}

RunRows runRows(const Json& summary, const fs::path& path) {
  RunRows rows;
  rows.first = wholeNumber(summary, "/run/first", path);
  rows.scans = wholeNumber(summary, "/run/scans", path);
  rows.drive_scans = wholeNumber(summary, "/run/drive_scans", path);
  const Json::json_pointer begin_at("/run/drive_begin_stamp_s");
  if (!summary.contains(begin_at) || !summary.at(begin_at).is_number()) {
    throw InputError(path.string() + ": no stamp at /run/drive_begin_stamp_s" + kRunAgain);
  }
  rows.drive_begin_stamp_s = summary.at(begin_at).get<double>();
  const Json::json_pointer without_pose_at("/run/without_pose");
  if (!summary.contains(without_pose_at) || !summary.at(without_pose_at).is_array()) {
    throw InputError(path.string() + ": no list at /run/without_pose" + kRunAgain);
  }
  const Json& without_pose = summary.at(without_pose_at);
  std::vector<bool> has_no_pose;
  for (const Json& scan : without_pose) {
    if (!scan.is_number_unsigned() || scan.get<std::size_t>() >= rows.scans) {
      throw InputError(path.string() + ": run.without_pose: must be scans of the run" + kRunAgain);
    }
    has_no_pose.resize(rows.scans, false);
    has_no_pose[scan.get<std::size_t>()] = true;
  }
  for (std::size_t i = 0; i < rows.scans; ++i) {
    if (has_no_pose.empty() || !has_no_pose[i]) rows.accepted.push_back(i);
  }
  return rows;
}

std::size_t firstTruthRow(const RunRows& rows, std::size_t truth_rows, const std::string& truth,
                          const std::string& run) {
  if (truth_rows == rows.drive_scans) return rows.first;
  if (truth_rows == rows.scans) return 0;
  throw InputError(truth + " has " + std::to_string(truth_rows) + " poses, " + run + " read " +
                   std::to_string(rows.scans) + " scans from scan " + std::to_string(rows.first) +
                   " on, of a drive of " + std::to_string(rows.drive_scans) +
                   ": they do not belong together; the ground truth needs a row for each scan of the drive");
}

}  // namespace fail_aware
