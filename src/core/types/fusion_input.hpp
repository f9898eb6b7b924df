// One input of the fusion (estimation/measurement_fusion.hpp): a measurement and the name of its source; and the list
// of the package's own sources.
#pragma once

#include <array>
#include <string>

#include "core/types/measurement.hpp"

namespace fail_aware {

struct FusionInput {
  enum class Kind {
    kPose,     ///< a whole pose from the sweep
    kPartial,  ///< from the sweep; observes some directions only: kUnobservedVariance in the others
    kMotion,   ///< like kPartial, but measures the motion since the last estimate, not the place in the map
    kExternal  ///< a whole pose from elsewhere: disagrees with another input only beyond both covariances (3 sigma)
  };

  bool isOfAnIcp() const { return name == kIcpPointToPoint || name == kIcpPointToPlane; }
  bool usable() const { return measurement != nullptr && measurement->ok(); }
  static constexpr bool isPartial(Kind kind) { return kind == Kind::kPartial || kind == Kind::kMotion; }

  std::string name;
  const Measurement* measurement = nullptr;  ///< null or not ok(): absent. Not owned
  Kind kind = Kind::kPose;
};

struct BuiltInSource {
  const char* name;
  FusionInput::Kind kind;
};

/// In the order of filter states and files, whole poses first. Offline the pipeline measures them
/// (odometry_pipeline.cpp), live the measurement nodelets.
inline constexpr std::array<BuiltInSource, 5> kBuiltInSources{{{kIcpPointToPoint, FusionInput::Kind::kPose},
                                                               {kIcpPointToPlane, FusionInput::Kind::kPose},
                                                               {kCornerSvd, FusionInput::Kind::kPose},
                                                               {kRoadProfile, FusionInput::Kind::kMotion},
                                                               {kAboveGround, FusionInput::Kind::kPartial}}};

}  // namespace fail_aware
