// The folder of an offline_odometry run. Readers can tell whether it contains all files of one run.
//
// A run writes its files into FOLDER/unfinished_ID and moves them into FOLDER when it is done. The last one is
// summary.json. It names the run ("run.id") and gives size and CRC-32 (zip's) of every other file ("files"), so that
// readers refuse an unfinished run and files of different runs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "json.hpp"

namespace fail_aware {

/// Writes a run. If two runs write into one folder at the same time, the one that began first fails at its end.
class RunFolder {
 public:
  /// `files`: the names of all results except summary.json. Creates the folders and removes what interrupted runs left.
  /// Throws InputError if the results cannot be written there.
  RunFolder(const std::filesystem::path& folder, std::vector<std::string> files);

  /// The folder for the files until finish().
  const std::filesystem::path& unfinished() const { return unfinished_; }

  /// Writes the summary with "run.id" and "files" added, and moves all files to `folder`. Throws std::runtime_error.
  Json finish(Json summary);

 private:
  std::filesystem::path folder_, unfinished_;
  std::vector<std::string> files_;
  std::string id_;
};

/// Writes "run.id" and "files" for the files in the folder: what finish() does, but without moving.
void sealRun(const std::filesystem::path& folder, const std::vector<std::string>& files, const std::string& id,
             Json& summary);

/// Reads a run's summary.json after checking all its files. Throws InputError with one line that says what to do: no
/// run there, an unfinished run, a file that is missing or was not written by the run, results of a version without
/// these checks. Cost: reads every file once.
Json readRunSummary(const std::filesystem::path& folder);

/// The scans of the drive that belong to the rows of a run's trajectory.
struct RunRows {
  std::size_t first = 0;              ///< index in the drive of the run's first scan (--first)
  std::size_t scans = 0;              ///< number of scans read; per_sweep.csv has a row for each
  std::size_t drive_scans = 0;        ///< of the whole drive
  double drive_begin_stamp_s = 0.0;   ///< the stamp of the drive's first scan
  std::vector<std::size_t> accepted;  ///< indices, among these scans, of those in the trajectories
};

/// Throws InputError if the summary lacks them. `path`: the summary's, for the message.
RunRows runRows(const Json& summary, const std::filesystem::path& path);

/// The row of the ground truth for scan 0 of the run. The ground truth has a row for each scan of the drive or for each
/// scan of the run. Throws InputError if it has neither.
std::size_t firstTruthRow(const RunRows& rows, std::size_t truth_rows, const std::string& truth,
                          const std::string& run);

}  // namespace fail_aware
