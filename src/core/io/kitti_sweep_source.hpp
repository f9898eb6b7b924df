// A drive in KITTI's folder layout (core/io/kitti_directory.hpp) as a source of sweeps.
#pragma once

#include <string>

#include "core/io/kitti_directory.hpp"
#include "core/io/sweep_source.hpp"

namespace fail_aware {

class KittiSweepSource : public SweepSource {
 public:
  /// Throws as KittiDirectory::open.
  explicit KittiSweepSource(const std::string& directory) : directory_(KittiDirectory::open(directory)) {}

  std::size_t size() const override { return directory_.size(); }
  void skip(std::size_t count) override { next_ += count; }
  ReadResult next(Sweep& sweep) override { return directory_.read(next_++, sweep); }
  std::string name() const override { return directory_.scanPaths().at(next_ - 1); }

 private:
  KittiDirectory directory_;
  std::size_t next_ = 0;
};

}  // namespace fail_aware
