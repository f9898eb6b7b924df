// The folder of a run of offline_odometry: it holds all files of one run, or says that it does not.
//
// A run writes its files into FOLDER/unfinished_ID and moves them into FOLDER when it is done. summary.json is the last
// one; it names the run ("run.id") and the size and the CRC-32 (that of zip) of every other file ("files"). Readers use
// these to refuse a run that did not finish and files of different runs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "json.hpp"

namespace fail_aware {

/// Writes a run. Two runs that write into one folder at the same time: the one that began first fails at its end.
class RunFolder {
 public:
  /// `files`: the names of all results but summary.json. Makes the folders and removes what runs that were cut off left
  /// behind. Throws InputError if the results cannot be written there.
  RunFolder(const std::filesystem::path& folder, std::vector<std::string> files);

  const std::string& id() const { return id_; }
  /// The files go here first.
  const std::filesystem::path& unfinished() const { return unfinished_; }

  /// Adds "run.id" and "files" to the summary, writes it, and moves all files to their place. Throws std::runtime_error.
  Json finish(Json summary);

 private:
  std::filesystem::path folder_, unfinished_;
  std::vector<std::string> files_;
  std::string id_;
};

/// Writes "run.id" and "files" for the files that are in the folder: what finish() does, in place.
void sealRun(const std::filesystem::path& folder, const std::vector<std::string>& files, const std::string& id,
             Json& summary);

/// summary.json of a run, after a check of all its files. Throws InputError, one line that says what to do: no run there, a
/// run that did not finish, a file that is missing or is not the one that the run wrote, results of a version that did
/// not mark its runs. Cost: every file is read once.
Json readRunSummary(const std::filesystem::path& folder);

/// Which scans of the drive the rows of a run's trajectory are.
struct RunRows {
  std::size_t first = 0;              ///< scan of the drive that the run began with (--first)
  std::size_t scans = 0;              ///< that the run read; per_sweep.csv has a row for each
  std::vector<std::size_t> accepted;  ///< of those, counted from 0: the trajectories have a row for each
};

/// Throws InputError if the summary does not hold it. `path`: the summary's, for the text.
RunRows runRows(const Json& summary, const std::filesystem::path& path);

/// The row of the ground truth for scan 0 of the run. The ground truth has a row for each scan of the drive, or for each
/// scan that the run read. Throws InputError if it has neither.
std::size_t firstTruthRow(const RunRows& rows, std::size_t truth_rows, const std::string& truth,
                          const std::string& run);

}  // namespace fail_aware
