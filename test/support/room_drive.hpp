// A made-up drive through a room, as a folder of scans in KITTI's layout.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

namespace fail_aware {

/// A room of 18 m x 55 m, in which the lidar moves by 0.5 m a sweep along x.
inline void writeScan(const std::filesystem::path& path, int sweep) {
  constexpr double kHeight_m = 1.73, kRadPerDeg = 0.017453292519943295;
  const double moved = 0.5 * sweep;
  std::ofstream file(path, std::ios::binary);
  for (int beam = 0; beam < 32; ++beam) {
    const double elevation = (-20.0 + 0.8 * beam) * kRadPerDeg;
    for (int degree = 0; degree < 360; ++degree) {
      const double x = std::cos(degree * kRadPerDeg) * std::cos(elevation);
      const double y = std::sin(degree * kRadPerDeg) * std::cos(elevation), z = std::sin(elevation);
      double range = z < 0.0 ? kHeight_m / -z : 1e3;
      range = std::min(range, (y > 0.0 ? 8.0 : 10.0) / std::max(std::abs(y), 1e-6));
      range = std::min(range, (x > 0.0 ? 30.0 - moved : 25.0 + moved) / std::max(std::abs(x), 1e-6));
      const float point[] = {static_cast<float>(range * x), static_cast<float>(range * y),
                             static_cast<float>(range * z), 0.5f};
      file.write(reinterpret_cast<const char*>(point), sizeof point);
    }
  }
}

inline constexpr int kRoomSweeps = 5;

inline void writeRoomDrive(const std::filesystem::path& drive) {
  std::filesystem::create_directories(drive / "velodyne");
  for (int i = 0; i < kRoomSweeps; ++i) writeScan(drive / "velodyne" / ("00000" + std::to_string(i) + ".bin"), i);
}

}  // namespace fail_aware
