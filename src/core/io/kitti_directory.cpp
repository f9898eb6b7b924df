#include "core/io/kitti_directory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <locale>
#include <optional>
#include <sstream>

#include "core/io/input_error.hpp"
#include "core/io/stamp_unit.hpp"
#include "core/io/text_lines.hpp"
#include "core/parameters/parameter_map.hpp"
#include "core/types/sweep_points.hpp"

namespace fail_aware {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPointBytes = 4 * sizeof(float);
constexpr std::size_t kMaxDigits = 18;  // of a file's number: fits into 64 bits

bool isNumber(const std::string& name) {
  return !name.empty() && name.size() <= kMaxDigits &&
         std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::vector<fs::path> scansIn(const fs::path& folder) {
  std::vector<fs::path> scans;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const bool hidden = it->path().filename().string().front() == '.';
    if (!hidden && it->path().extension() == ".bin") scans.push_back(it->path());
  }
  return scans;
}

/// The folder with the times of the scans in `scans`, which may be DIR/velodyne or DIR/velodyne_points/data.
fs::path driveOf(const fs::path& scans) {
  fs::path folder = fs::absolute(scans).lexically_normal();
  if (folder.filename().empty()) folder = folder.parent_path();
  const fs::path parent = folder.parent_path();
  if (folder.filename() == "velodyne") return parent;
  return folder.filename() == "data" && parent.filename() == "velodyne_points" ? parent.parent_path() : scans;
}

/// Returns the scans' numbers in ascending order and sorts `scans` likewise. If a name is not a number: returns an
/// empty list and sorts by name.
std::vector<std::uint64_t> sortScans(std::vector<fs::path>& scans) {
  std::sort(scans.begin(), scans.end());
  std::vector<std::pair<std::uint64_t, fs::path>> numbered;
  for (const fs::path& scan : scans) {
    const std::string stem = scan.stem().string();
    if (!isNumber(stem)) return {};
    numbered.emplace_back(std::stoull(stem), scan);
  }
  std::sort(numbered.begin(), numbered.end());
  std::vector<std::uint64_t> numbers;
  for (std::size_t i = 0; i < numbered.size(); ++i) {
    if (i > 0 && numbered[i].first == numbers.back()) {
      throw InputError(scans[i - 1].string() + " and " + numbered[i].second.string() + " have the same number");
    }
    numbers.push_back(numbered[i].first);
    scans[i] = numbered[i].second;
  }
  return numbers;
}

/// Lines without blanks at both ends, and without empty lines at the end of the file.
std::vector<std::string> readLines(const fs::path& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be read");
  skipByteOrderMark(file, path.string());
  std::vector<std::string> lines;
  for (std::string line; nextLine(file, line);) {
    lines.push_back(trimmed(line));
  }
  while (!lines.empty() && lines.back().empty()) lines.pop_back();
  return lines;
}

InputError badLine(const fs::path& path, std::size_t i, const std::string& line, const char* what) {
  return InputError(path.string() + ", line " + std::to_string(i + 1) + ": '" + line + "' " + what);
}

/// "; no scan has the number 20" for the first hole in the numbers; empty: there is none.
std::string firstHole(const std::vector<std::uint64_t>& numbers) {
  const auto hole =
      std::adjacent_find(numbers.begin(), numbers.end(), [](std::uint64_t a, std::uint64_t b) { return b != a + 1; });
  return hole == numbers.end() ? "" : "; no scan has the number " + std::to_string(*hole + 1);
}

/// Single stamps may go back; if most do, the lines are in another order than the scans.
void requireRising(const fs::path& path, const std::vector<std::string>& lines, const std::vector<double>& times_s) {
  std::size_t back = 0, first = 0;
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    if (times_s[i] < times_s[i - 1] && back++ == 0) first = i;
  }
  if (2 * back + 1 > times_s.size()) {
    throw badLine(path, first, lines[first], "is before the line above it, and so are most lines: times must rise");
  }
}

std::vector<double> readScanTimes(const fs::path& path, std::size_t scan_count,
                                  const std::vector<std::uint64_t>& numbers) {
  const std::vector<std::string> lines = readLines(path);
  if (lines.size() != scan_count) {
    throw InputError(path.string() + ": " + std::to_string(lines.size()) + " lines for " + std::to_string(scan_count) +
                     " scans" + firstHole(numbers));
  }

  std::vector<double> times_s;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    double time_s = 0.0;
    if (!parseDouble(lines[i], time_s) || !std::isfinite(time_s)) {
      throw badLine(path, i, lines[i], "is not a number of seconds");
    }
    times_s.push_back(wholeMicroseconds(time_s));
  }
  requireSeconds(path.string(), times_s);
  requireRising(path, lines, times_s);
  return times_s;
}

/// 2011-09-26 13:02:25.964389445 -> s since 1970.
std::optional<double> secondsOf(const std::string& line) {
  std::istringstream text(line);
  text.imbue(std::locale::classic());
  std::tm date = {};
  double second = 0.0;
  if (!(text >> std::get_time(&date, "%Y-%m-%d %H:%M:") >> second)) return std::nullopt;
  if (text.peek() != std::istringstream::traits_type::eof() || !(second >= 0.0 && second < 61.0)) return std::nullopt;
  const std::time_t minute_s = timegm(&date);
  return static_cast<double>(minute_s) + second;
}

/// KITTI raw: a date and time for each scan number, also for missing files. Returns seconds since the first scan.
std::vector<double> readTimestamps(const fs::path& path, const std::vector<std::uint64_t>& numbers) {
  const std::vector<std::string> lines = readLines(path);
  if (numbers.back() >= lines.size()) {
    throw InputError(path.string() + ": " + std::to_string(lines.size()) + " lines, none for scan " +
                     std::to_string(numbers.back()));
  }
  const auto at = [&](std::size_t i) {
    const std::optional<double> time_s = secondsOf(lines[i]);
    if (!time_s) throw badLine(path, i, lines[i], "is not a date and time such as 2011-09-26 13:02:25.964");
    return *time_s;
  };
  const double first_s = at(numbers.front());
  std::vector<double> times_s;
  times_s.reserve(numbers.size());
  for (const std::uint64_t number : numbers) times_s.push_back(wholeMicroseconds(at(number) - first_s));
  return times_s;
}

bool readBytes(const std::string& path, std::vector<char>& bytes) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return false;
  const std::streamoff size = file.tellg();
  if (size < 0) return false;
  bytes.resize(static_cast<std::size_t>(size));
  file.seekg(0);
  return bytes.empty() || static_cast<bool>(file.read(bytes.data(), size));
}

/// Reads one T per point of the scan; otherwise `values` is empty and the message says why.
template <class T>
std::string readSideFile(const std::string& path, std::size_t point_count, std::vector<T>& values) {
  values.clear();
  std::vector<char> bytes;
  if (!readBytes(path, bytes)) return path + ": missing or cannot be read";
  if (bytes.size() != point_count * sizeof(T)) {
    return path + ": " + std::to_string(bytes.size()) + " bytes, but " + std::to_string(point_count) + " points need " +
           std::to_string(point_count * sizeof(T));
  }
  values.resize(point_count);
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return {};
}

/// The valid returns alone.
void keepReturns(const std::vector<char>& bytes, Sweep& sweep) {
  const std::size_t count = bytes.size() / kPointBytes;
  sweep.points_lidar.reserve(count);
  sweep.intensities.reserve(count);
  std::vector<std::size_t> kept;
  kept.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    float v[4];
    std::memcpy(v, &bytes[i * kPointBytes], kPointBytes);
    const Eigen::Vector3f point(v[0], v[1], v[2]);
    if (!isUsablePoint(point)) continue;
    sweep.points_lidar.push_back(point);
    sweep.intensities.push_back(std::isfinite(v[3]) ? v[3] : 0.0f);
    kept.push_back(i);
  }
  keepValues(kept, sweep.times_s);
  keepValues(kept, sweep.rings);
  sweep.points_dropped = count - kept.size();
}

}  // namespace

KittiDirectory KittiDirectory::open(const std::string& directory, double nominal_period_s) {
  requirePositive("nominal_period_s", nominal_period_s);
  fs::path root(directory);
  std::error_code error;
  if (fs::is_regular_file(root, error)) {
    throw InputError(directory + ": is a file; a folder with velodyne/NNNNNN.bin is needed");
  }
  if (!fs::is_directory(root, error)) throw InputError(directory + ": no such directory");
  if (fs::exists(root / kKittiUnfinished, error)) {
    throw InputError(directory + ": its drive was not written to its end; remove the folder and write it again");
  }

  std::vector<fs::path> scans;
  for (const fs::path& folder : {root / "velodyne", root / "velodyne_points" / "data", root}) {
    scans = scansIn(folder);
    if (!scans.empty()) break;
  }
  if (scans.empty()) {
    throw InputError(directory + ": no scans (*.bin) in velodyne/, velodyne_points/data/ or the directory itself");
  }
  if (fs::equivalent(scans.front().parent_path(), root, error)) root = driveOf(root);

  KittiDirectory kitti;
  const std::vector<std::uint64_t> numbers = sortScans(scans);
  for (const fs::path& scan : scans) kitti.scan_paths_.push_back(scan.string());
  const fs::path timestamps = root / "velodyne_points" / "timestamps.txt";
  if (fs::exists(root / "times.txt", error)) {
    kitti.stamps_s_ = readScanTimes(root / "times.txt", scans.size(), numbers);
  } else if (fs::equivalent(scans.front().parent_path(), timestamps.parent_path() / "data", error) &&
             fs::exists(timestamps, error)) {
    if (numbers.empty()) throw InputError(timestamps.string() + ": the scans in data/ must have numbers as names");
    kitti.stamps_s_ = readTimestamps(timestamps, numbers);
  } else {
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const double number = static_cast<double>(numbers.empty() ? i : numbers[i]);
      kitti.stamps_s_.push_back(wholeMicroseconds(number * nominal_period_s));
    }
  }
  if (fs::is_directory(root / "stamps", error)) kitti.stamps_folder_ = (root / "stamps").string();
  if (fs::is_directory(root / "rings", error)) kitti.rings_folder_ = (root / "rings").string();
  return kitti;
}

ReadResult KittiDirectory::read(std::size_t i, Sweep& sweep) const {
  sweep.stamp_s = i < size() ? stamps_s_[i] : 0.0;
  clearPoints(sweep);
  if (i >= size()) {
    return {ReadStatus::kNoPoints, "scan " + std::to_string(i) + ": there are only " + std::to_string(size())};
  }

  const std::string& path = scan_paths_[i];
  std::vector<char> bytes;
  if (!readBytes(path, bytes)) return {ReadStatus::kNoPoints, path + ": cannot be read"};
  if (bytes.empty()) return {ReadStatus::kNoPoints, path + ": empty file"};
  if (bytes.size() % kPointBytes != 0) {
    return {ReadStatus::kNoPoints,
            path + ": " + std::to_string(bytes.size()) + " bytes is not a multiple of " + std::to_string(kPointBytes)};
  }

  const std::size_t count = bytes.size() / kPointBytes;
  const std::string stem = fs::path(path).stem().string();
  std::string message;
  if (hasPointTimes()) message = readSideFile(stamps_folder_ + "/" + stem + ".f32", count, sweep.times_s);
  if (!rings_folder_.empty()) {
    const std::string rings_message = readSideFile(rings_folder_ + "/" + stem + ".u16", count, sweep.rings);
    if (message.empty()) message = rings_message;
  }
  keepReturns(bytes, sweep);
  if (sweep.empty()) {
    return {ReadStatus::kNoPoints, path + ": none of " + std::to_string(count) + " points is finite and a return"};
  }
  return {message.empty() ? ReadStatus::kOk : ReadStatus::kSideFileUnusable, message};
}

}  // namespace fail_aware
